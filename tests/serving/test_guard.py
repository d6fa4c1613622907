"""What the server refuses, and what goes with all it gives."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from dse.serving.application import application
from dse.serving.guard import Limits
from dse.serving.study_index import StudyIndex

TOKEN = "a token of the test"  # noqa: S105  # it is

POST = b"POST /stop HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nContent-Type: application/json\r\n"


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "10.0.0.1", "", "localhost@evil", "[::1"])
def test_a_name_that_is_not_this_machine_s_is_refused(client, host: str) -> None:
    answer = client.get("/", Host=host or "x")
    assert answer.status == 421
    assert "first" not in answer.text


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1:99", "[::1]:8470", "LOCALHOST:1"])
def test_loopback_has_several_names_and_a_tunnel_another_port(client, host: str) -> None:
    assert client.get("/", Host=host).status == 200


def test_two_hosts_are_none(client) -> None:
    with socket.create_connection(("127.0.0.1", client.port)) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\nConnection: close\r\n\r\n")
        assert connection.recv(100).split()[1] in (b"400", b"421")


@pytest.mark.parametrize("origin", ["", "null", "http://evil.example", "https://127.0.0.1", "http://127.0.0.1:1"])
@pytest.mark.parametrize("path", ["/stop?study=out/first", "/simulate?study=out/first"])
def test_what_changes_something_is_only_asked_by_our_own_pages(client, origin: str, path: str) -> None:
    assert client.post(path, {}, Origin=origin).status == 403


@pytest.mark.parametrize("kind", ["", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data"])
def test_what_a_form_of_another_page_could_send_is_refused(client, kind: str) -> None:
    assert client.post("/stop?study=out/first", {}, Content_Type=kind).status == 415


@pytest.mark.parametrize("path", ["/stop?study=out/first", "/simulate?study=out/first"])
def test_a_get_changes_nothing(client, path: str) -> None:
    assert client.get(path).status == 405


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "TRACE", "PATCH", "CONNECT"])
def test_other_methods_are_refused(client, method: str) -> None:
    assert client.ask(method, "/").status == 405


def test_a_long_body_is_refused_whether_its_length_is_told_or_not(client) -> None:
    long = {"configuration": "c" * 70_000, "point": {}}
    assert client.post("/simulate?study=out/first", long).status == 413
    with socket.create_connection(("127.0.0.1", client.port)) as connection:
        connection.sendall(POST + b"Transfer-Encoding: chunked\r\n\r\n")
        connection.sendall(b"11170\r\n" + b" " * 0x11170 + b"\r\n0\r\n\r\n")
        assert connection.recv(100).split()[1] == b"413"


def test_a_body_that_never_comes_is_not_waited_for(workshop: Path, served) -> None:
    with (
        served(application(StudyIndex(workshop), limits=Limits(seconds=0.2))) as client,
        socket.create_connection(("127.0.0.1", client.port)) as connection,
    ):
        connection.sendall(POST + b"Content-Length: 10\r\n\r\n{")
        assert connection.recv(100).split()[1] == b"408"


def test_a_head_of_any_length_is_not_read(client) -> None:
    with socket.create_connection(("127.0.0.1", client.port)) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"x" * 100_000)
        answer = connection.recv(100)
    assert answer == b"" or answer.split()[1].startswith(b"4")


def test_who_asks_too_often_has_to_wait(workshop: Path, served) -> None:
    with served(application(StudyIndex(workshop), limits=Limits(burst=5, rate=0.001))) as client:
        assert [client.get("/nothing").status for _ in range(7)] == [404] * 5 + [429] * 2


@pytest.mark.parametrize(
    "path", ["/", "/study/out/first/", "/compare?a=out/first&b=out/second", "/progress?study=out/first", "/nothing"]
)
def test_every_answer_says_what_a_browser_must_not_do_with_it(client, path: str) -> None:
    headers = client.get(path).headers
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["x-frame-options"] == "DENY"
    assert headers["cache-control"] == "no-store"
    assert "server" not in headers
    assert "access-control-allow-origin" not in headers


@pytest.mark.parametrize("path", ["/", "/study/out/first/", "/compare?a=out/first&b=out/second", "/study/nothing/"])
def test_pages_run_only_their_own_code_and_ask_only_their_own_server(client, path: str) -> None:
    text = client.get(path).text
    policy = text.split('Content-Security-Policy" content="')[1].split('"')[0]
    assert "default-src 'none'" in policy
    assert "connect-src 'self'" in policy
    assert "unsafe" not in policy
    assert " style=" not in text.split("<body>")[1]


def test_without_the_token_nothing_is_shown_and_nothing_is_done(workshop: Path, served) -> None:
    with served(application(StudyIndex(workshop), token=TOKEN)) as client:
        asked = [client.get("/"), client.get("/study/out/first/"), client.get("/?token=wrong"), client.get("/?token=")]
        asked += [client.post("/stop?study=out/first", {}), client.post("/stop?token=a+token+of+the+test", {})]
        assert [answer.status for answer in asked] == [401] * 6
        assert not any("first" in answer.text or "set-cookie" in answer.headers for answer in asked)


def test_the_token_is_shown_once_and_kept_where_no_script_reads_it(workshop: Path, served) -> None:
    with served(application(StudyIndex(workshop), token=TOKEN.replace(" ", "-"))) as client:
        answer = client.get("/?token=a-token-of-the-test")
        cookie, *marks = answer.headers["set-cookie"].split("; ")
        assert answer.status == 200
        assert "token" not in answer.text
        assert {*marks} == {"HttpOnly", "SameSite=Strict", "Path=/"}
        known = type(client)(client.port, cookie)
        assert "out/first" in known.get("/").text
        name, _, value = cookie.partition("=")
        strangers = (f"{name}={value}x", f"{name}=", f"other={value}", "\x7f;;=")
        assert [type(client)(client.port, each).get("/").status for each in strangers] == [401] * 4


def test_a_server_for_others_goes_by_numbers_and_its_own_names_alone(workshop: Path, served) -> None:
    with served(application(StudyIndex(workshop), is_open=True)) as client:
        assert client.get("/", Host="192.168.7.9:8470").status == 200
        assert client.get("/", Host=socket.gethostname()).status == 200
        assert client.get("/", Host="evil.example").status == 421
