"""Elastic constants of the material as a whole, from periodic cells and from finite specimens (theory section 2).

Modules are imported where they are used. What a case needs is in :mod:`fissura.case.macroscopic`, and needs none of
them.
"""
