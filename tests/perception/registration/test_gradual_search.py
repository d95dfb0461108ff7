from igrip.perception.registration.gradual_search import FIT, GradualSearch


def steps(costs, found, log):
    for cost in costs:
        log.append(cost)
        yield cost
    return found


def test_each_frame_does_no_more_than_its_budget():
    log = []
    search = GradualSearch()
    assert not search.busy
    assert search.go_on(None) is None
    search.begin(steps([30] * 6, {"mug": "fit"}, log), 2.0)
    assert search.busy
    assert search.begun == 2.0
    done, frames = None, 0
    while done is None:
        before = len(log)
        done = search.go_on(2 * (30 + FIT))
        assert len(log) - before <= 2
        frames += 1
    assert frames == 4  # six steps, two a frame, and the end
    assert done.fits == {"mug": "fit"}
    assert done.t == 2.0
    assert not search.busy
    assert search.go_on(None) is None


def test_without_a_budget_all_is_done_at_once():
    log = []
    search = GradualSearch()
    search.begin(steps([100] * 50, {}, log), 0.0)
    assert search.go_on(None).fits == {}
    assert len(log) == 50


def test_what_is_stopped_gives_nothing():
    search = GradualSearch()
    search.begin(steps([1], {"mug": "fit"}, []), 0.0)
    search.stop()
    assert search.go_on(None) is None
    assert search.begun is None
