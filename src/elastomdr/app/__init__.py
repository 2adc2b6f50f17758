"""`elastomdr app`: the way from a DMA file to friction in a page, on this machine only
(needs the extra `app`).
"""
