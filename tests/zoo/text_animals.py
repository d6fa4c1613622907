"""FMUs whose string output is a trap: ANIMALS of the same kind, but what they give is never read in a study."""

from __future__ import annotations

from collections.abc import Mapping

from zoo.animals import HALF, Animal

# A string of one gigabyte that costs a megabyte: the same page file mapped a thousand times, one after the other.
_GIGABYTE = """\
static char *gigabyte(void)
{
    enum { PIECE = 1 << 20, PIECES = 1 << 10 };
    int file = memfd_create("text", 0);
    if (ftruncate(file, PIECE))
        abort();
    char *base = mmap(NULL, (size_t)PIECE * PIECES + 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    for (size_t i = 0; i < PIECES; i++)
        mmap(base + i * PIECE, PIECE, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
    memset(base, 'x', PIECE);
    close(file);
    return base;
}
"""

TEXT_ANIMALS: Mapping[str, Animal] = {
    "one_gigabyte": Animal(
        {"step": "a->text = gigabyte();"}, ("head.text", "16 MiB", "at t = 0.6 s"), before=_GIGABYTE
    ),
    "no_text": Animal({"step": "a->text = NULL;"}, ("head.text", "at t = 0.6 s")),
    "not_utf8": Animal({"step": r'a->text = "\xff\xfe\x80";'}),
    "its_own_buffer": Animal(
        # What a string points to need not outlive the next call (FMI 2.0.4, 2.1.7).
        {"get": 'static char room[32]; sprintf(room, "%g", a->time); a->text = room;'},
    ),
    "refuses_texts": Animal({"step": "a->text = NULL; return fmi2Error;"}, (HALF,)),
}
