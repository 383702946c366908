"""The paper's three experiments, reproduced, and the same questions asked again with errors that can be compared."""
