"""Many tasks computed side by side: what ensembles, studies and calibrations share.

`machines` says where tasks are computed and how many at a time, `computing` has them computed and kept one by one, in
`processes` of this machine or on a Dask `cluster`; `resuming` tells whether a folder may be gone on with, and
`progress` shows how far it is. What a task is, and what is left of it, is the business of other rooms.
"""
