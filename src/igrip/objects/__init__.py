"""What can be grasped: models of objects, catalogues of them, and their poses as tracked."""
