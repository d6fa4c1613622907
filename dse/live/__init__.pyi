from .offline import bench_of_drive as bench_of_drive
from .packet import Flag as Flag, Packet as Packet, PacketError as PacketError, pack as pack, unpack as unpack
