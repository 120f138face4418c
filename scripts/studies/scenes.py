"""The scene that studies of k share: water through the pores of one model under its own weight."""

PORES = """scene = {{ name = "{name}"; method = "stokes"; }};
model = {{ file = "{model}"; }};
fluids = ( {{ name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; }} );
force = {{ body_acceleration = ["0", "0", "-9.80665 m/s^2"]; }};
"""


def write_pores(path, name, model, more=""):
    with open(path, "w", encoding="utf-8") as file:
        file.write(PORES.format(name=name, model=model) + more)
