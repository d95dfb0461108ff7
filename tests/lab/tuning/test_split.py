from collections import Counter

from igrip.lab.tuning.split import folds_of


def test_every_group_is_in_one_fold_and_folds_are_even():
    groups = [f"g{k // 3}" for k in range(33)]  # eleven groups of three trials
    folds = folds_of(groups, 5, seed=3)
    assert all(len(set(folds[k : k + 3].tolist())) == 1 for k in range(0, 33, 3))
    assert sorted(Counter(folds.tolist()).values()) == [6, 6, 6, 6, 9]
    assert folds.tolist() == folds_of(groups, 5, seed=3).tolist()
    assert folds.tolist() != folds_of(groups, 5, seed=4).tolist()


def test_there_are_never_more_folds_than_groups():
    assert sorted(folds_of(["a", "b"], 5, seed=0).tolist()) == [0, 1]
    assert folds_of(["a", "a"], 5, seed=0).tolist() == [0, 0]
