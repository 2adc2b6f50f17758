"""The public names of `elastomdr.fit` and where they live, for editors and type checkers."""

from ..io.data import Dma as Dma
from ..io.data import FitWarning as FitWarning
from ..io.data import dma as dma
from ..io.data import join as join
from ..io.data import relaxation as relaxation
from .calibration import Calibration as Calibration
from .calibration import calibrate as calibrate
from .grosch import FrictionMaster as FrictionMaster
from .grosch import friction_master as friction_master
from .master import MasterCurve as MasterCurve
from .master import master_curve as master_curve
from .payne import SofteningFit as SofteningFit
from .payne import softening as softening
from .pipeline import MaterialFit as MaterialFit
from .pipeline import from_hardness as from_hardness
from .pipeline import material as material
from .report import abaqus_card as abaqus_card
from .report import ansys_card as ansys_card
from .report import comsol_card as comsol_card
from .report import dyna_card as dyna_card
from .report import plain_card as plain_card
from .report import radioss_card as radioss_card
from .series import PronyFit as PronyFit
from .series import prony as prony
from .shear_law import AdhesionFit as AdhesionFit
from .shear_law import adhesion as adhesion
