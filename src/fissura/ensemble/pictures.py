"""Pictures of an ensemble's page: what draws each, its caption, and what it shows."""

from fissura.ensemble.crack_picture import plot_crack_starts
from fissura.ensemble.curve_picture import plot_curves
from fissura.ensemble.peak_pictures import plot_convergence, plot_papers, plot_peaks
from fissura.ensemble.study_pictures import plot_study_curves, plot_study_peaks
from fissura.pictures.registered import Picture

CURVES = Picture(
    plot_curves,
    "Load curves with mean and percentile band",
    "Each thin line is a run. Mean and band are taken at the same gauge, or at the same dissipated energy if the "
    "gauge of any run turns back. A run that has ended does not count beyond its end; where runs are missing, the "
    "mean is dashed and the band is paler. Runs that stopped early are no part of either.",
)

CURVES_BY_VALUE = Picture(
    plot_study_curves,
    "Load curves by the values of what is varied",
    "A colour for each point of the study; where it has several runs, these are thin lines, and the thick one is "
    "their mean, up to where the first of them ends.",
)

PEAKS_BY_VALUE = Picture(
    plot_study_peaks,
    "Peak loads over what is varied",
    "Dots are runs, lines join means where all other values are the same. Bars are 95 % intervals of the mean by "
    "Student's t. All points have the same seeds: differences between them are surer than bars say.",
)

PEAKS = Picture(
    plot_peaks,
    "Histogram of the peak loads",
    "Fitted by maximum likelihood. p is the probability of a worse fit by the test of Anderson and Darling if the "
    "distribution is the right one.",
)

PAPERS = Picture(
    plot_papers,
    "Probability plots of the peak loads",
    "The distribution is a straight line. Points are at median ranks (i − 0.3)/(n + 0.4). Bounds are for the "
    "fitted line, at each probability for itself, by a parametric bootstrap of pivots.",
)

CRACK_STARTS = Picture(
    plot_crack_starts,
    "Where cracks started",
    "The centroid of the first contact that opened by G_t/f_t of the material's means: it has lost about two "
    "thirds of its strength in tension there.",
)

CONVERGENCE = Picture(
    plot_convergence,
    "Convergence of mean and coefficient of variation",
    "Intervals of the mean by Student's t, of the coefficient of variation after Vangel (1996), for independent "
    "runs from a Gaussian population.",
)
