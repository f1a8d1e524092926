"""Trained policies from other libraries as agents: stable-baselines3, torchrl, plain torch.

``wrapping`` recognises a policy by its methods, without importing its library. Each supported
library has a module with a subclass of ``Policy``.
"""
