"""Calibration: keys of a case found from measured curves, with their standard errors.

`problem` says what is unknown and what was measured, `study_file` and `asked` make it from a file and from arguments,
`observed` puts measured and computed curves on common points, `runs` has designs computed by ensembles with the same
seeds, `surrogate` fits curves as functions of the unknowns, `search` decides what to run next with
``scipy.optimize.least_squares`` on the surrogate, `uncertainty` makes standard errors from the scatter of the seeds.
`result`, `picture`, `report` and `written` tell what was found; `runner` leads.
"""
