"""One file per command; nothing else prints or exits."""


def main() -> None:
    """Run the command line in this process, which then ends; the console script ``dse``."""
    # Imports take a second on a busy machine, and whoever interrupts them wants no traceback: the first few are caught
    # here, the others end the process at once.
    try:
        from dse.cli.signals import end_at_once

        end_at_once()
        from dse.cli.streams import mend_streams

        mend_streams()
        import sys

        from dse.cli.answers import answer

        if answer(sys.argv[1:]):
            return
        from dse.cli.entry import run
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    run()


__all__ = ["main"]
