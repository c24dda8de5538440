"""Studies: many adaptive runs against the same specimens at full resolution, and what they say together.

`definition` reads what is run, `execute` runs one task into a `record`, `store` tells what is done, `runner` leads.
`measures` compares two records, `result` all of them; `statistics`, `report` and `pictures` tell what came out.
"""
