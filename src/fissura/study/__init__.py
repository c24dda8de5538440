"""Studies: many adaptive runs against the same specimens at full resolution, and what they say together.

`plan` reads what is run, `execute` runs one task into a `record`, `store` tells what is done, `runner` leads.
`measures` compares two records, `outcome` all of them; `statistics`, `report` and `pictures` tell what came out.
"""
