"""The mesh component measured on held-out shapes."""
