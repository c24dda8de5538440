"""Many realisations of one case: planned from one seed, computed by Dask, kept one by one, evaluated together.

`plan` says what is run and with which seeds, `outcome` computes one realisation, `cluster` has them computed, `store`
keeps them, `runner` leads, `progress` shows how far it is. `table`, `band`, `statistics` (with `distributions` and
`convergence`), `result`, `pictures` and `report` evaluate what is on disk.

Names are imported from these modules, or as ``fissura.run_ensemble`` and ``fissura.EnsembleResult``: planning an
ensemble needs no Dask, and computing a realisation no pictures.
"""
