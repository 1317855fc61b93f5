"""The engine: declares, plans, keys, stores and runs stages. Knows no physics."""
