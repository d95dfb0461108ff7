"""Mutants of a source file, made by Cosmic Ray's operators, and their code objects.

Left out are changes that hardly ever mean a plausible slip (bit operators on floats, powers,
decorators, types of exceptions) and those of annotations, which nothing reads.
"""

from __future__ import annotations

import ast
from pathlib import Path
from types import CodeType

ARITHMETIC = ("Add", "Sub", "Mul", "Div", "FloorDiv", "Mod")
COMPARISONS = ("Eq", "NotEq", "Lt", "LtE", "Gt", "GtE")
OPERATORS = (
    *(f"ReplaceBinaryOperator_{a}_{b}" for a in ARITHMETIC for b in ARITHMETIC[:4] if a != b),
    *(f"ReplaceComparisonOperator_{a}_{b}" for a in COMPARISONS for b in COMPARISONS if a != b),
    "ReplaceComparisonOperator_Is_IsNot", "ReplaceComparisonOperator_IsNot_Is",
    "ReplaceUnaryOperator_Delete_USub", "ReplaceUnaryOperator_Delete_Not", "AddNot",
    "ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ReplaceAndWithOr", "ReplaceOrWithAnd",
    "ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "NumberReplacer",
    "ZeroIterationForLoop",
)  # fmt: skip


class Skeleton(ast.NodeTransformer):
    """Removes annotations, and the bodies of functions if asked to."""

    def __init__(self, bodies: bool) -> None:
        self.bodies = bodies

    def visit_FunctionDef(self, node):
        node.returns = None
        if not self.bodies:
            node.body = [ast.Pass()]
        self.generic_visit(node)
        return node

    def visit_arg(self, node):
        node.annotation = None
        return node

    def visit_AnnAssign(self, node):
        node.annotation = ast.Constant(None)
        self.generic_visit(node)
        return node


def shape(source: str, bodies: bool) -> str:
    """Return what two sources have to share to be the same but for what is removed."""
    return ast.dump(Skeleton(bodies).visit(ast.parse(source)))


def mutants_of(path: Path) -> list[str]:
    """Return the source of every mutant of a file."""
    from cosmic_ray import plugins
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.mutating import mutate_code

    source = path.read_text()
    tree, found = get_ast(source), {}
    for name in OPERATORS:
        operator = plugins.get_operator(f"core/{name}")()
        places = sum(1 for node in ast_nodes(tree) for _ in operator.mutation_positions(node))
        for place in range(places):
            mutant = mutate_code(source, operator, place)
            found[mutant] = None
    same = shape(source, bodies=True)
    return [mutant for mutant in found if shape(mutant, bodies=True) != same]


def codes(code: CodeType) -> list[CodeType]:
    """Return all code objects in one, in the order of the source."""
    inner = [constant for constant in code.co_consts if isinstance(constant, CodeType)]
    return [code, *(each for one in inner for each in codes(one))]


def by_name(code: CodeType) -> dict[tuple[str, int], CodeType]:
    """Return code objects by qualified name, and number among those of one name."""
    named: dict[tuple[str, int], CodeType] = {}
    for each in codes(code):
        number = sum(1 for name, _ in named if name == each.co_qualname)
        named[each.co_qualname, number] = each
    return named
