"""Who may connect."""

from __future__ import annotations

import pytest

from igrip.errors import IgripError
from igrip.runtime.access import Access, is_loopback

TOKEN = "a-token-of-some-length"


@pytest.mark.parametrize("host", ["127.0.0.1", "::1", "localhost", "127.1.2.3"])
def test_loopback_needs_no_token(host):
    assert is_loopback(host)
    assert Access(host).refusal("/intentions", {}) is None


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.0.7", "example.org", ""])
def test_every_other_address_needs_one(host):
    assert not is_loopback(host)
    with pytest.raises(IgripError, match="token"):
        Access(host)
    access = Access(host, TOKEN)
    assert access.refusal("/intentions", {}) is not None
    assert access.refusal("/intentions?token=wrong", {}) is not None
    assert access.refusal(f"/intentions?token={TOKEN}", {}) is None
    assert access.refusal("/", {"Authorization": f"Bearer {TOKEN}"}) is None
    assert access.refusal("/", {"Authorization": "Bearer ünknown"}) is not None


def test_a_token_that_can_be_guessed_is_refused():
    with pytest.raises(IgripError, match="16"):
        Access("127.0.0.1", "1234")


@pytest.mark.parametrize(
    "origin", ["https://evil.example", "null", "http://localhost.evil.example", "file://"]
)
def test_pages_of_elsewhere_do_not_get_in_through_the_browser(origin):
    assert Access("127.0.0.1").refusal("/observations", {"Origin": origin}) is not None
    headers = {"Origin": origin, "Authorization": f"Bearer {TOKEN}"}
    assert Access("127.0.0.1", TOKEN).refusal("/observations", headers) is None


@pytest.mark.parametrize("origin", ["http://localhost:3000", "http://127.0.0.1", "http://[::1]:8"])
def test_pages_of_this_machine_do(origin):
    assert Access("127.0.0.1").refusal("/observations", {"Origin": origin}) is None
