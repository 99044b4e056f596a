"""--note-passed FILE: the names of the tests that pass are written there. --leave-out FILE: those named
there are not run. So `make test-all` runs what `make test` has left out or, for want of a package,
skipped, and nothing twice."""

import pytest


def pytest_addoption(parser):
    parser.addoption("--note-passed", metavar="FILE")
    parser.addoption("--leave-out", metavar="FILE")


def pytest_configure(config):
    config.passed_here = []


def _name(nodeid):
    return nodeid.rsplit("/", 1)[-1]


def pytest_collection_modifyitems(config, items):
    path = config.getoption("--leave-out")
    if path is None:
        return
    with open(path) as file:
        known = set(file.read().splitlines())
    left_out = [item for item in items if _name(item.nodeid) in known]
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if _name(item.nodeid) not in known]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    if report.when == "call" and report.passed:
        item.config.passed_here.append(_name(item.nodeid))
    return report


def pytest_sessionfinish(session):
    path = session.config.getoption("--note-passed")
    if path is not None:
        with open(path, "w") as file:
            file.writelines(f"{name}\n" for name in session.config.passed_here)
