"""The constant at a later visit: averaged over the base model and everything that may be missing.

``kernels`` says what each cause may do, ``priors`` how often and how much, ``average`` weighs them
by the determinations and predicts.
"""
