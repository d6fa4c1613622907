"""A sandbox for the processes that run FMUs: no network, and nothing written but in folders of theirs. Linux only.

Landlock decides by folder what may be read and written (linux/landlock.h), a seccomp filter refuses system calls that
Landlock knows nothing of (linux/seccomp.h). Neither can be taken off again, and what the process starts inherits both.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from errno import ENOSYS, EPERM
from multiprocessing import resource_tracker
from multiprocessing.process import BaseProcess
from pathlib import Path

from dse.cache import cache_folder
from dse.errors import DseError, Location, fail
from dse.processes import start_process, unburdened

_SYSTEM = ("/bin", "/sbin", "/lib", "/lib32", "/lib64", "/usr", "/opt", "/etc", "/nix/store", "/gnu/store", "/proc", "/sys/devices/system")  # fmt: skip  # noqa: E501
_DEVICES = ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")

# Rights of Landlock, by the version that brought them. In its own folders a process makes files and folders; no links,
# sockets, pipes or devices, which who reads the folder from outside could be led astray with.
_EXECUTE, _WRITE, _READ, _LIST = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_REMOVE, _MAKE = 3 << 4, 1 << 7 | 1 << 8
_MOVE, _TRUNCATE, _CONTROL = 1 << 13, 1 << 14, 1 << 15
_RIGHTS = {1: (1 << 13) - 1, 2: _MOVE, 3: _TRUNCATE, 5: _CONTROL}
_SCOPES = 3
"""Signals, and sockets with abstract names, stay among the processes of the sandbox."""
_SCOPES_SINCE = 6

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_CAPABILITIES_3, _DAC_OVERRIDE = 0x20080522, 1 << 1
_SET_NO_NEW_PRIVS, _SET_SECCOMP, _FILTER = 38, 22, 2

_MACHINES = {"x86_64": (0xC000003E, 0), "aarch64": (0xC00000B7, 1)}
"""What the kernel calls the machine, and which number of a system call below is its."""

REFUSED = """
socket 41 198, connect 42 203, bind 49 200, listen 50 201, accept 43 202, accept4 288 242, io_uring_setup 425 425,
io_uring_enter 426 426, io_uring_register 427 427, ptrace 101 117, process_vm_readv 310 270,
process_vm_writev 311 271, process_madvise 440 440, pidfd_getfd 438 438, kcmp 312 272, mount 165 40, umount2 166 39,
pivot_root 155 41, chroot 161 51, open_tree 428 428, move_mount 429 429, fsopen 430 430, fsconfig 431 431,
fsmount 432 432, fspick 433 433, mount_setattr 442 442, unshare 272 97, setns 308 268, truncate 76 45, chmod 90 -,
fchmod 91 52, fchmodat 268 53, fchmodat2 452 452, chown 92 -, fchown 93 55, lchown 94 -, fchownat 260 54, utime 132 -,
utimes 235 -, futimesat 261 -, utimensat 280 88, setxattr 188 5, lsetxattr 189 6, fsetxattr 190 7, removexattr 197 14,
lremovexattr 198 15, fremovexattr 199 16, setxattrat 463 463, removexattrat 466 466, file_setattr 469 469,
open_by_handle_at 304 265, fanotify_init 300 262, inotify_add_watch 254 27, quotactl 179 60, quotactl_fd 443 443,
kexec_load 246 104, kexec_file_load 320 294, bpf 321 280, perf_event_open 298 241, userfaultfd 323 282,
keyctl 250 219, add_key 248 217, request_key 249 218, init_module 175 105, finit_module 313 273,
delete_module 176 106, reboot 169 142, swapon 167 224, swapoff 168 225, acct 163 89, settimeofday 164 170,
clock_settime 227 112, clock_adjtime 305 266, adjtimex 159 171, sethostname 170 161, setdomainname 171 162,
iopl 172 -, ioperm 173 -, vhangup 153 58, syslog 103 116, setpriority 141 140, ioprio_set 251 30,
sched_setscheduler 144 119, sched_setparam 142 118, sched_setattr 314 274, shmget 29 194, shmat 30 196, shmctl 31 195,
msgget 68 186, msgsnd 69 189, msgrcv 70 188, msgctl 71 187, semget 64 190, semop 65 193, semctl 66 191,
semtimedop 220 192, mq_open 240 180, mq_unlink 241 181
"""
"""System calls that are refused, with their numbers on x86_64 and aarch64."""

_ABSENT = ((435, 435), (437, 437))
"""clone3 and openat2: what they are asked for cannot be seen, and programs do without where the kernel has none."""

_SOCKETPAIR, _CLONE, _OPENAT, _IOCTL, _PRLIMIT = (53, 199), (56, 220), (257, 56), (16, 29), (302, 261)
_SETRLIMIT, _SECCOMP = (160, 164), (317, 277)
_SIGNALLING = (((62, 129), 1), ((200, 130), 1), ((234, 131), 2), ((129, 138), 1), ((297, 240), 2))
"""kill, tkill, tgkill, rt_sigqueueinfo and rt_tgsigqueueinfo, with the place of the signal among their arguments."""
_SET_FILTER, _ALL_THREADS, _NOT_SLOWER = 1, 1, 4
_OPEN = 2
_NEW_NAMESPACES = 0x7E020000
_O_TRUNC, _O_ACCMODE = 0o1000, 3
_ASKING = (0x5401, 0x802C542A, 0x5413, 0x541B, 0x5421, 0x5450, 0x5451)
"""What a program asks of an open file: whether it is a terminal, how much there is to read, whether it waits."""


@dataclass(frozen=True, slots=True)
class Sandbox:
    """Processes in it write in *folders* only, and read there and in *readable*, besides the system and Python.

    The first of *folders* is for what the FMUs themselves write; all are made if they do not exist.
    """

    folders: tuple[Path, ...]
    readable: tuple[Path, ...] = ()

    def start(self, process: BaseProcess, *files: Path) -> None:
        """Start *process* in the sandbox, for good; it may write into *files*, too. DseError where there is none."""
        from concurrent.futures import ThreadPoolExecutor

        abi()
        for folder in self.folders:
            folder.mkdir(parents=True, exist_ok=True)
        with unburdened():
            resource_tracker.ensure_running()  # it serves other processes, too
        # Both restrict the thread that asks for it, and what it starts: so the process has no thread that is free.
        with ThreadPoolExecutor(1) as thread:
            thread.submit(self._start, process, files).result()

    def move_in(self) -> None:
        """Have this process write where it may: for what gives no folder, and for what asks for a temporary one."""
        home = self.folders[0].absolute()
        os.environ["TMPDIR"] = tempfile.tempdir = str(home)
        os.chdir(home)
        _moved_in.append(self)

    def _start(self, process: BaseProcess, files: Iterable[Path]) -> None:
        ruleset = self._ruleset(files)
        try:
            _call("prctl", _SET_NO_NEW_PRIVS, 1, 0, 0, 0)
            _drop_capabilities()
            _call("syscall", _RESTRICT_SELF, ruleset, 0)
        finally:
            os.close(ruleset)
        program = _filter(platform.machine())
        held = ctypes.create_string_buffer(program)
        _call("prctl", _SET_SECCOMP, _FILTER, struct.pack("HxxxxxxP", len(program) // 8, ctypes.addressof(held)), 0, 0)
        start_process(process)

    def _ruleset(self, files: Iterable[Path]) -> int:
        version = abi()
        known = sum(rights for since, rights in _RIGHTS.items() if since <= version)
        scopes = _SCOPES if version >= _SCOPES_SINCE else 0
        asked = struct.pack("3Q", known, 0, scopes)[: 24 if scopes else 8]
        ruleset = _call("syscall", _CREATE_RULESET, asked, len(asked), 0)
        reading = _EXECUTE | _READ | _LIST
        for path in (*map(Path, _SYSTEM), *_of_python(), cache_folder().absolute(), *self.readable):
            _allow(ruleset, path, reading & known)
        for file in (*map(Path, _DEVICES), *files):
            _allow(ruleset, file, (_READ | _WRITE | _TRUNCATE) & known)
        for folder in self.folders:
            if folder.is_symlink():
                # It may lead anywhere, and a study folder may come from anybody.
                raise fail("is a link: in a sandbox only folders can be written", Location(str(folder)))
            _allow(ruleset, folder, (reading | _WRITE | _REMOVE | _MAKE | _MOVE | _TRUNCATE) & known)
        return ruleset


_moved_in: list[Sandbox] = []


def protect_parent() -> None:
    """Have this process ended by the kernel if it signals the one that started it or its group, or sets its limits.

    Setting a limit of its own that cannot be raised, only lowered, has no effect. Both hold for what it starts, too,
    and for good. Without Linux's seccomp nothing is changed.
    """
    if sys.platform != "linux" or platform.machine() not in _MACHINES:
        return
    import resource

    every = {value for name, value in vars(resource).items() if name.startswith("RLIMIT_")}
    kinds = [kind for kind in sorted(every) if len({*resource.getrlimit(kind)}) == 1]
    program = _parent_filter(platform.machine(), kinds)
    held = ctypes.create_string_buffer(program)
    described = struct.pack("HxxxxxxP", len(program) // 8, ctypes.addressof(held))
    number = _SECCOMP[_MACHINES[platform.machine()][1]]
    with suppress(OSError):
        _call("prctl", _SET_NO_NEW_PRIVS, 1, 0, 0, 0)
        _call("syscall", number, _SET_FILTER, _ALL_THREADS | _NOT_SLOWER, described)


def is_inside() -> bool:
    """Whether this process is in a sandbox, and has moved in."""
    return bool(_moved_in)


def enforced() -> str:
    """What holds in a sandbox on this machine, in words. Raises DseError if there can be none."""
    version = abi()
    signals = "no signals to other processes" if version >= _SCOPES_SINCE else "but signals to other processes (kernel < 6.12)"  # fmt: skip  # noqa: E501
    return f"no network, no writing outside of their scratch folder, {signals} (Landlock ABI {version}, seccomp)"


def abi() -> int:
    """The version of Landlock here. Raises DseError if there is no sandbox on this machine."""
    if sys.platform != "linux":
        raise _refused(f"there is none on {platform.system()}")
    machine = platform.machine()
    if machine not in _MACHINES or sys.maxsize < 2**32:
        raise _refused(f"there is none for processors called {machine}")
    try:
        return _call("syscall", _CREATE_RULESET, None, 0, 1)
    except OSError as error:
        raise _refused(f"this kernel has no Landlock, or does not let it be used ({error.strerror})") from error


def _refused(why: str) -> DseError:
    return fail(f"no sandbox: {why}", hint="leave --sandbox out only if you trust the FMUs, or use a virtual machine")


def _of_python() -> Iterable[Path]:
    """Where Python's modules lie, and those of the packages it finds; never the home or the current folder as such."""
    named = [*sys.path, *os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)]
    listed = {Path(entry).absolute() for entry in named if entry} - {Path.home(), Path.cwd()}
    own = (Path(__file__).parents[1], Path(sys.executable).parent, Path(sys.executable).resolve().parent)
    return {*listed, *own, Path(sys.prefix), Path(sys.base_prefix)}


def _drop_capabilities() -> None:
    """Give up what root may do, but to reach files whoever they belong to, as far as the rules let it."""
    head = struct.pack("Ii", _CAPABILITIES_3, 0)
    held = ctypes.create_string_buffer(24)
    _call("capget", head, ctypes.addressof(held))
    (permitted,) = struct.unpack_from("4xI", held.raw)
    kept = permitted & _DAC_OVERRIDE
    _call("capset", head, struct.pack("6I", kept, kept, 0, 0, 0, 0))


def _allow(ruleset: int, path: Path, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return  # what is not there needs no rule
    try:
        of_a_file = rights & (_EXECUTE | _READ | _WRITE | _TRUNCATE)
        granted = rights if path.is_dir() else of_a_file
        _call("syscall", _ADD_RULE, ruleset, 1, struct.pack("=Qi", granted, place), 0)
    finally:
        os.close(place)


def _call(name: str, *arguments: int | bytes | None) -> int:
    """A function of the C library that returns -1 on an error, which is raised as OSError."""
    library = ctypes.CDLL(None, use_errno=True)
    words = [ctypes.c_long(each) if isinstance(each, int) else ctypes.c_char_p(each) for each in arguments]
    function = library[name]
    function.restype = ctypes.c_long
    answer: int = function(*words)
    if answer < 0:
        error = ctypes.get_errno()
        raise OSError(error, os.strerror(error))
    return answer


_LOAD, _AND, _RETURN = 0x20, 0x54, 0x06
_EQUALS, _AT_LEAST, _ANY_BIT = 0x15, 0x35, 0x45
_ALLOW, _ERROR, _KILL = 0x7FFF0000, 0x00050000, 0x80000000
_NUMBER, _MACHINE, _ARGUMENTS = 0, 4, 16


def _filter(machine: str) -> bytes:
    """The seccomp filter for *machine* (linux/bpf_common.h): a call is looked at by its number, some by arguments."""
    audit, column = _MACHINES[machine]
    refuse = [_step(_RETURN, _ERROR | EPERM)]
    absent = [_step(_RETURN, _ERROR | ENOSYS)]
    allow = [_step(_RETURN, _ALLOW)]
    entries = (entry.split() for entry in REFUSED.replace("\n", " ").split(","))
    refused = [int(entry[1 + column]) for entry in entries if entry[1 + column] != "-"]
    program = [
        _step(_LOAD, _MACHINE), *_unless(_EQUALS, audit, [_step(_RETURN, _KILL)]),
        _step(_LOAD, _NUMBER), *_if(_AT_LEAST, 0x40000000, absent),
    ]  # fmt: skip
    for number in refused:
        program += _if(_EQUALS, number, refuse)
    for pair in _ABSENT:
        program += _if(_EQUALS, pair[column], absent)
    # Only pairs of connected streams, which lead nowhere: a datagram could be sent to any socket with a name.
    stream = [_argument(1), _step(_AND, 15), *_unless(_EQUALS, 1, refuse)]
    program += _if(_EQUALS, _SOCKETPAIR[column], [_argument(0), *_unless(_EQUALS, 1, refuse), *stream, *allow])
    program += _if(_EQUALS, _CLONE[column], [_argument(0), *_if(_ANY_BIT, _NEW_NAMESPACES, refuse), *allow])
    # Limits of other processes.
    program += _if(_EQUALS, _PRLIMIT[column], [_argument(0), *_unless(_EQUALS, 0, refuse), *allow])
    asking = [step for request in _ASKING for step in _if(_EQUALS, request, allow)]
    program += _if(_EQUALS, _IOCTL[column], [_argument(1), *asking, *refuse])
    # To empty a file without asking to write it: early versions of Landlock do not notice.
    opens = [(_OPENAT[column], 2)] + ([(_OPEN, 1)] if machine == "x86_64" else [])
    for number, flags in opens:
        emptied = [*_if(_EQUALS, _O_TRUNC, refuse), *_if(_EQUALS, _O_TRUNC | _O_ACCMODE, refuse)]
        program += _if(_EQUALS, number, [_argument(flags), _step(_AND, _O_TRUNC | _O_ACCMODE), *emptied, *allow])
    return b"".join(program + allow)


def _parent_filter(machine: str, kinds: Iterable[int]) -> bytes:
    """The filter of `protect_parent`: limits of *kinds* are only said to be set."""
    audit, column = _MACHINES[machine]
    allow, kill, done = ([_step(_RETURN, answer)] for answer in (_ALLOW, _KILL, _ERROR))
    program = [_step(_LOAD, _MACHINE), *_unless(_EQUALS, audit, allow), _step(_LOAD, _NUMBER)]
    named = (os.getppid(), 0, -1, -os.getpgrp())
    targets = [_argument(0), *(step for one in named for step in _if(_EQUALS, one & 0xFFFFFFFF, kill)), *allow]
    for pair, signal in _SIGNALLING:
        # Signal 0 only asks whether there is such a process.
        program += _if(_EQUALS, pair[column], [_argument(signal), *_if(_EQUALS, 0, allow), *targets])
    ours = [*(step for kind in kinds for step in _if(_EQUALS, kind, done)), *allow]
    program += _if(_EQUALS, _SETRLIMIT[column], [_argument(0), *ours])
    reading = _if(_EQUALS, 0, [_step(_LOAD, _ARGUMENTS + 8 * 2 + 4), *_if(_EQUALS, 0, allow)])
    own = [*_unless(_EQUALS, 0, _unless(_EQUALS, os.getpid(), allow)), _argument(3), *_unless(_EQUALS, 0, allow)]
    of_whom = [_argument(0), *_if(_EQUALS, os.getppid(), kill), *own]
    program += _if(_EQUALS, _PRLIMIT[column], [_argument(2), *reading, *of_whom, _argument(1), *ours])
    return b"".join(program + allow)


def _step(code: int, value: int, yes: int = 0, no: int = 0) -> bytes:
    return struct.pack("HBBI", code, yes, no, value)


def _argument(index: int) -> bytes:
    return _step(_LOAD, _ARGUMENTS + 8 * index)  # the lower half; both machines are little-endian


def _if(test: int, value: int, then: list[bytes]) -> list[bytes]:
    return [_step(test, value, 0, len(then)), *then]


def _unless(test: int, value: int, then: list[bytes]) -> list[bytes]:
    return [_step(test, value, len(then), 0), *then]
