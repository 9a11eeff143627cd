"""What gyros and accelerometers put out: forward models from attitudes and the earth's rotation.

Every simulated record starts from where the body points (quaternions) and from the rotation of
the earth. Nothing here is an estimator, and no estimator's equation stands here.
"""
