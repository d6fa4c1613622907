from .checks import Check as Check, Checked as Checked, Latencies as Latencies
from .client import ClientLine as ClientLine, connected_line as connected_line
from .client_check import check_client as check_client
from .datagram_tap import (
    Datagram as Datagram,
    listen_at as listen_at,
    read_recording as read_recording,
    tap as tap,
    write_datagram as write_datagram,
    write_head as write_head,
)
from .driver_in_the_loop import (
    DRIVER as DRIVER,
    DriverInTheLoop as DriverInTheLoop,
    can_be_driven as can_be_driven,
    driver_of as driver_of,
    prepare_driver as prepare_driver,
    put_driver_in_the_loop as put_driver_in_the_loop,
    with_driver as with_driver,
)
from .layout import (
    Layout as Layout,
    Signal as Signal,
    component_layout as component_layout,
    offset_of as offset_of,
    read_layout as read_layout,
    unnamed_layout as unnamed_layout,
    wholes_of as wholes_of,
    written_layout as written_layout,
)
from .others import Car as Car
from .packet import (
    MOST_VALUES as MOST_VALUES,
    Flag as Flag,
    Packet as Packet,
    PacketError as PacketError,
    pack as pack,
    size_of as size_of,
    unpack as unpack,
)
from .packet_mistakes import explain as explain
from .recorded_drive import bench_of_drive as bench_of_drive
from .seat import MOTION as MOTION, Script as Script, SeatSession as SeatSession, Sights as Sights
from .session import Ended as Ended, Patience as Patience, Seen as Seen, Session as Session, Why as Why
from .shared_bench import (
    START as START,
    Sharing as Sharing,
    sharing_of as sharing_of,
    without_traffic as without_traffic,
)
from .shared_world import Place as Place, SharedWorld as SharedWorld
from .world import News as News, What as What, require_free as require_free, serve_world as serve_world
from .world_check import WorldTrial as WorldTrial, check_world as check_world
from .world_traffic import traffic_left_out as traffic_left_out, traffic_of as traffic_of
