from .application import application as application
from .drives import MOST_AT_ONCE as MOST_AT_ONCE, LiveDrives as LiveDrives
from .guard import Limits as Limits
from .server import LOOPBACK as LOOPBACK, PORT as PORT, Announced as Announced, serve as serve
from .shared_drives import SharedDrives as SharedDrives
from .study_index import StudyIndex as StudyIndex
