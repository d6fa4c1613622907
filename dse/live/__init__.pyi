from .packet import (
    MOST_VALUES as MOST_VALUES,
    Flag as Flag,
    Packet as Packet,
    PacketError as PacketError,
    pack as pack,
    size_of as size_of,
    unpack as unpack,
)
