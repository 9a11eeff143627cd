"""FOG and MEMS rate sensor forward models."""
