"""Problems with exact answers; `steady.PROBLEMS` and `radok.PROBLEMS` list them."""
