from .packet import Flag as Flag, Packet as Packet, PacketError as PacketError, pack as pack, unpack as unpack
from .world import News as News, What as What, require_free as require_free, serve_world as serve_world
