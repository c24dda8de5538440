import json
import subprocess
from datetime import UTC, datetime

import pytest

from fissura.results import provenance

from .synthetic import steps
from .test_summary import summary_of


def test_a_summary_tells_where_its_numbers_come_from():
    summary = json.loads(json.dumps(summary_of(steps([100.0, 300.0, 200.0]))))
    assert summary["commit"] == provenance.commit()
    assert set(summary["machine"]) == {"system", "processor", "processors", "memory_bytes"}
    assert summary["machine"]["processors"] >= 1
    assert summary["machine"]["memory_bytes"] > 1e8
    written = datetime.fromisoformat(summary["date"])
    assert summary["date"].endswith("Z")
    assert abs((datetime.now(UTC) - written).total_seconds()) < 3600


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A copy of the tree's layout in a repository of its own, from which the program seems to run."""
    place = tmp_path / "src" / "fissura" / "results" / "provenance.py"
    place.parent.mkdir(parents=True)
    place.write_text("first\n")
    git = ("git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b")
    for words in (("init", "-q"), ("add", "."), ("commit", "-q", "-m", "one"), ("tag", "v1")):
        subprocess.run([*git, *words], check=True)
    monkeypatch.setattr(provenance, "__file__", str(place))
    provenance.commit.cache_clear()
    yield place
    provenance.commit.cache_clear()


def test_the_commit_of_a_tree(repository):
    shown = subprocess.run(
        ["git", "-C", str(repository.parent), "rev-parse", "HEAD"], capture_output=True, text=True, check=True
    )
    assert provenance.commit() == shown.stdout.strip()
    provenance.commit.cache_clear()
    repository.write_text("second\n")
    assert provenance.commit() == shown.stdout.strip() + "-dirty"


@pytest.mark.parametrize(
    ("noted", "found"),
    [
        ('{"url": "https://x/y.git", "vcs_info": {"vcs": "git", "commit_id": "abc"}}', "abc"),
        ('{"url": "file:///x", "dir_info": {"editable": true}}', None),
        ("[]", None),
        ("{", None),
        (None, None),
    ],
)
def test_the_commit_that_pip_noted(tmp_path, monkeypatch, noted, found):
    class Package:
        def read_text(self, name):
            assert name == "direct_url.json"
            return noted

    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "a" / "b" / "c" / "provenance.py"))
    monkeypatch.setattr(provenance.metadata, "distribution", lambda name: Package())
    provenance.commit.cache_clear()
    assert provenance.commit() == found
    provenance.commit.cache_clear()


def test_without_git_the_commit_is_unknown(repository, monkeypatch):
    def missing(*args, **options):
        raise FileNotFoundError("git")

    monkeypatch.setattr(provenance.subprocess, "run", missing)
    assert provenance.commit() is None
