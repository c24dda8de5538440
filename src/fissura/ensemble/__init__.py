"""Many realisations of one case: planned from one seed, computed side by side, kept one by one, evaluated together.

`plan` says what is run and with which seeds, `outcome` computes one realisation, `cluster` has them computed, `store`
keeps them and `kept` looks at what is there, `runner` leads, `progress` shows how far it is. `table`, `band`,
`statistics` (with `distributions` and `convergence`), `result`, `pictures` and `report` evaluate what is on disk.

Names are imported from these modules, or as ``fissura.run_ensemble`` and ``fissura.EnsembleResult``: planning an
ensemble and computing it on this machine need no Dask, computing a realisation no pictures.
"""
