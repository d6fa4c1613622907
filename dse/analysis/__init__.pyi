from .boxes import Box as Box, best_boxes as best_boxes
from .choice import Choice as Choice, choice_of as choice_of, prices_of as prices_of
from .conditions import (
    Condition as Condition,
    WorstCase as WorstCase,
    share_met as share_met,
    worst_case as worst_case,
    worst_designs as worst_designs,
)
from .counterfactuals import claim as claim, what_would_change as what_would_change
from .data import ALL as ALL, Factor as Factor, StudyData as StudyData
from .decision import (
    BoundChange as BoundChange,
    Decision as Decision,
    Side as Side,
    decide_between as decide_between,
    is_price as is_price,
)
from .design_ranking import (
    Missed as Missed,
    Ranking as Ranking,
    Standing as Standing,
    objectives_of as objectives_of,
    ranked as ranked,
    unit_of_objective as unit_of_objective,
)
from .effects import (
    MainEffect as MainEffect,
    main_effects as main_effects,
)
from .finding import Finding as Finding, Topic as Topic
from .first_order import (
    Share as Share,
    alias_sentences as alias_sentences,
    aliased as aliased,
    courses as courses,
    going_together as going_together,
    interacting as interacting,
)
from .importance import (
    Importance as Importance,
    Importances as Importances,
    Together as Together,
    importances as importances,
    model_first_order_shares as model_first_order_shares,
)
from .limits import Limit as Limit
from .narrowing import (
    Narrowing as Narrowing,
    around as around,
    around_designs as around_designs,
    of_band as of_band,
    of_box as of_box,
)
from .optimality import Stage as Stage, stages as stages, static_bound as static_bound, strength as strength
from .order import severities_of as severities_of, severity_levels as severity_levels
from .paired import PairedDraws as PairedDraws, case_label as case_label, noisy as noisy, value_label as value_label
from .probability import (
    Basis as Basis,
    Interval as Interval,
    Met as Met,
    probability_met as probability_met,
    wilson as wilson,
)
from .radial import (
    Formula as Formula,
    centres_of as centres_of,
    drawn as drawn,
    evaluated as evaluated,
    features as features,
    formulas as formulas,
)
from .robust import Centre as Centre, robust_centre as robust_centre
from .sensitivity_indices import (
    Designed as Designed,
    Effects as Effects,
    IndexEstimates as IndexEstimates,
    morris_effects as morris_effects,
    sobol_indices as sobol_indices,
)
from .slack import slack_of_runs as slack_of_runs
from .study_findings import essentials as essentials, findings as findings
from .study_reader import planes as planes, study_data as study_data
