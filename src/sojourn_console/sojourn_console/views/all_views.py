"""The views of the page, in the order in which they are drawn and listed."""

from sojourn_console.views.force_view import ForceView
from sojourn_console.views.ground_view import GroundView
from sojourn_console.views.layer_views import ClosedView, SlopeView
from sojourn_console.views.machine_view import MachineView, TruthView
from sojourn_console.views.sensor_views import CameraView, CloudView
from sojourn_console.views.shadow_view import ShadowView
from sojourn_console.views.sun_view import SunView
from sojourn_console.views.way_view import PlanView, TrackView, UncertaintyView
from sojourn_console.views.zone_view import ZoneView

VIEWS = (
    SunView, GroundView, ShadowView, MachineView, TruthView, PlanView, TrackView, UncertaintyView, CloudView,
    CameraView, ForceView, ZoneView, SlopeView, ClosedView,
)  # fmt: skip
