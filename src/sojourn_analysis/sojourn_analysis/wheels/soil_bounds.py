"""The parameters of a soil that trials of a wheel can tell, and where they may lie."""

EXIT_LAMBDA = "exit_lambda"
"""Stands for `exit_angle: lambda:L` among the parameters."""

PHYSICAL_BOUNDS: dict[str, tuple[float, float]] = {
    "n": (0.4, 1.8),
    "k_phi": (1e4, 1e9),
    "cohesion": (0.0, 3e3),
    "friction_angle_deg": (20.0, 50.0),
    "interface_friction_angle_deg": (0.5, 0.8),  # of the friction angle: Potyondy 1961, sand on metal
    "shear_modulus": (0.001, 0.05),
    "shear_modulus_lateral": (0.001, 0.05),
    "theta_m_c1": (0.0, 0.8),
    "theta_m_c2": (-0.4, 0.6),
    "theta_m_c3": (0.0, 0.6),
    EXIT_LAMBDA: (0.0, 1.0),
    "slip_sinkage": (0.0, 4.0),  # Lyasko 2010: (1 + s)/(1 - s/2), fourfold at s = 1, is a growth of 3
    "skid_sinkage": (0.0, 10.0),
    "side_sinkage": (0.0, 10.0),
    "bulldozing_modulus": (0.005, 0.1),
}
"""Parameters that can be identified, and where they may lie: what has been measured on soils for wheels."""
