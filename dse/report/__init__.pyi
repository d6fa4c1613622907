from .charts.chart import (
    Axis as Axis,
    Band as Band,
    Bars as Bars,
    Chart as Chart,
    Line as Line,
    Points as Points,
    Rule as Rule,
    Steps as Steps,
)
from .charts.problems import chart_problems as chart_problems
from .content.data import (
    ConfigurationEntry as ConfigurationEntry,
    MetricColumn as MetricColumn,
    Property as Property,
    ReportContent as ReportContent,
    ReportVariable as ReportVariable,
    RequirementRow as RequirementRow,
    Runs as Runs,
    SamplerKind as SamplerKind,
)
from .content.reading import content_of_run as content_of_run, read_content as read_content
from .content.scenes import with_replays as with_replays
from .drawing.chart import draw_chart as draw_chart
from .drawing.road_mesh import write_mesh as write_mesh
from .drawing.road_picture import RoadPicture as RoadPicture
from .drawing.road_plot import draw_road as draw_road
from .drawing.scenario_plot import draw_scenario as draw_scenario
from .drawing.style import save_drawing as save_drawing
from .figure import (
    FIGURES as FIGURES,
    Figure as Figure,
    PrintedFigure as PrintedFigure,
    View as View,
    configuration_called as configuration_called,
    drawings as drawings,
    uses_insight as uses_insight,
)
from .figures.waveforms import draw_run as draw_run
from .insight.reading import insight_of as insight_of, read_insight as read_insight, read_report as read_report
from .page.html import (
    HEAD as HEAD,
    ICON as ICON,
    bundle as bundle,
    hash_of as hash_of,
    served_page as served_page,
    write_report as write_report,
)
from .page.payload import script_json as script_json
from .page.pdf import print_report as print_report
from .page.simulation import PageSimulation as PageSimulation
from .roads import road_picture as road_picture, with_driven as with_driven
from .scene.data import Ground as Ground, Host as Host, Scene as Scene
from .scene.film import VIEWS as VIEWS, Shot as Shot, film as film, require_target as require_target
from .scene.from_signals import SceneSignals as SceneSignals
from .scene.ground import ground_of as ground_of, straight_ground as straight_ground
from .scene.html import (
    LiveScene as LiveScene,
    scene_document as scene_document,
    scene_mark as scene_mark,
    scene_page as scene_page,
)
from .trace.data import Trace as Trace, parts_with as parts_with, rear_axle_of as rear_axle_of
from .trace.layout import write_layout as write_layout
from .trace.write import (
    MESSAGES as MESSAGES,
    chosen_part as chosen_part,
    frames_of as frames_of,
    require_packages as require_packages,
    write_mcap as write_mcap,
    write_osi as write_osi,
)
