from .packet import Flag as Flag, Packet as Packet, PacketError as PacketError, pack as pack, unpack as unpack
