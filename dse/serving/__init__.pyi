from .application import application as application
from .guard import Limits as Limits
from .server import LOOPBACK as LOOPBACK, PORT as PORT, Announced as Announced, serve as serve
from .shelf import Shelf as Shelf
