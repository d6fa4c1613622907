from .offline import bench_of_drive as bench_of_drive
from .packet import Flag as Flag, Packet as Packet, PacketError as PacketError, pack as pack, unpack as unpack
from .seat import (
    DRIVER as DRIVER,
    Seat as Seat,
    can_be_driven as can_be_driven,
    driver_of as driver_of,
    prepare_seat as prepare_seat,
    take_seat as take_seat,
    with_driver as with_driver,
)
from .session import Ended as Ended, Patience as Patience, Seen as Seen, Session as Session, Why as Why
