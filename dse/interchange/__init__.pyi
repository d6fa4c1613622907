from .importing.coded import ImportedCode as ImportedCode, import_code as import_code
from .importing.component import import_component as import_component
from .importing.scenario import (
    ImportedScenario as ImportedScenario,
    ImportedTraffic as ImportedTraffic,
    import_scenario as import_scenario,
)
from .importing.ssp import import_ssp as import_ssp
from .prepared import (
    PreparedPackage as PreparedPackage,
    check_ssp as check_ssp,
    prepare_ssp as prepare_ssp,
)
from .resolving.resolve import ResolvedSystem as ResolvedSystem
from .structure import ExperimentSettings as ExperimentSettings
from .writing.scenario import DrivenEntity as DrivenEntity, scenario_text as scenario_text
from .writing.write import write_ssp as write_ssp
