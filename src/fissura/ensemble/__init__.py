"""Many realisations of one case: planned from one seed, computed by Dask, kept one by one, evaluated together.

`plan` says what is run and with which seeds, `outcome` computes one realisation, `cluster` has them computed, `store`
keeps them, `runner` leads, `command` is the command line. `table`, `band`, `statistics` (with `distributions` and
`convergence`), `result`, `pictures` and `report` evaluate what is on disk.

Names are imported from these modules, or as ``fissura.run_ensemble`` and ``fissura.EnsembleResult``: the command line
imports this room whatever it is asked to do, so it must not bring NumPy along.
"""
