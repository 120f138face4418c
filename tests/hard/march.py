"""Hard cases of any step: the watchdog, the step that effects choose, restart after a step back."""
import os
import re

from suite import Run, case, explain, force_power, holds, row, slit, slit_velocity, whole
from water import scene


@case("A step twice too long: the watchdog sees it, steps back, halves, and the answer is right", fast=True)
def step_taken_back():
    limit = explain(slit(8))["dt_limit"]
    run = Run(slit(8), [f"wcsph.dt={2 * limit:.17g} s", "wcsph.force_dt=true"])
    yield holds("the run ends, and says what it did", "", run.code == 0 and len(run.backs) == 1, "; ".join(run.backs) or run.message[-150:])
    yield row("k over exact", "0.5/N^2 twice", run.json["darcy_velocity"][0] / slit_velocity(8e-4, 1e-3, 0.1), 1, 1 / 64)
    yield holds("/run/limits counts the watchdog's steps", "", run.limits.get("watchdog", 0) > 0, str(run.limits))
    plain = Run(slit(8))
    yield holds("a run that is never out of bounds has no record of it", "", plain.backs == [] and len(plain.limits) == 1 and "watchdog" not in plain.limits, str(plain.limits))


@case("A restart after a step back must go on with the halved step, bit for bit", fast=True)
def restart_after_a_step_back():
    limit = explain(slit(8))["dt_limit"]
    sets = [f"wcsph.dt={2 * limit:.17g} s", "wcsph.force_dt=true", "scene.steady_tolerance=0"]
    whole_run = Run(slit(8), sets)
    half = Run(slit(8), sets + ["scene.end_time=0.5 s", "checkpoint.interval=1 ms"])
    rest = Run(slit(8), sets, out=half.folder, resume=True)
    yield holds("the first half stepped back", "", len(half.backs) == 1, str(half.backs))
    yield holds("the checkpoint was taken up", "", rest.code == 0 and rest.backs == half.backs and "starting anew" not in rest.message, rest.message.strip()[-150:])
    yield row("Darcy velocity, difference", "bit for bit", rest.json["darcy_velocity"][0] - whole_run.json["darcy_velocity"][0], 0, 0)


@case("Twelve times too long: three halvings do not help, and the run ends as the interface says", fast=True)
def given_up_after_three():
    limit = explain(slit(8))["dt_limit"]
    run = Run(slit(8), [f"wcsph.dt={12 * limit:.17g} s", "wcsph.force_dt=true"])
    yield row("exit code", "interfaces.md", run.code, 4, 0)
    for what, word in (("particle", "particle"), ("place", " m "), ("cause", "time step"), ("mend", 'wcsph.dt = "auto"'), ("checkpoint", "out.ckpt.hdf")):
        yield holds(f"the message names the {what}", "", word in run.message, run.message.strip()[-250:])
    yield holds("the checkpoint is there", "", os.path.exists(run.prefix + ".ckpt.hdf"))


@case("What leaves its bounds must be seen before it spoils the state: within ten steps", fast=True)
def seen_within_ten_steps():
    # From rest v = g t in the middle of the slit: it passes the speed of sound at a time known beforehand.
    c, g, dt = 0.144, 1000.0, 1e-6
    run = Run(slit(8, g=g), [f"wcsph.sound_speed={c} m/s", f"wcsph.dt={dt:g} s"])
    first = re.search(r"t = ([0-9.e-]+) s: (\w+)", run.message)
    yield row("steps from leaving the bound to being seen", "the issue: ten; the first half step is the leapfrog's", (float(first[1]) - c / g) / dt, 5, 5)
    yield holds("the bound is the velocity's, the cause the sound speed", "", first[2] == "velocity" and "raise wcsph.sound_speed" in run.message, run.message.strip()[-200:])


@case("isph: a step of several particles' way", fast=True)
def isph_step_taken_back():
    text = scene((0.4, 0.3), 0.01, [("water", (0, 0, 0.15, 0.2), "")], 0.4, isph='dt = "8 ms";')
    run = Run(text)
    yield holds("steps are taken back until they are short enough, and recorded", "", run.code == 0 and run.backs, "; ".join(run.backs)[:150] or run.message[-150:])
    late = Run(scene((0.4, 0.3), 0.01, [("water", (0, 0, 0.15, 0.2), 'velocity = ["5 m/s", "0"];')], 0.4, isph='dt = "30 ms";'))
    yield row("beyond help: exit code", "interfaces.md", late.code, 4, 0)
    yield holds("beyond help: particle, cause, mend, checkpoint", "", all(w in late.message for w in ("particle", "time step", 'isph.dt = "auto"', "ckpt")), late.message.strip()[-200:])


@case("Which effect limits the step: gravity at first, then advection, and with much viscosity viscosity", fast=True)
def step_of_the_effects():
    dam = [("water", (0, 0, 0.1, 0.15), "")]
    free = Run(scene((0.3, 0.3), 0.01, dam, 0.3))
    yield holds("water set free: the force first, then advection", "", free.limits.get("force", 0) > 0 and free.limits.get("advection", 0) > 10, str(free.limits))
    thick = Run(scene((0.3, 0.3), 0.01, dam, 0.05).replace("1e-3 Pa s", "10 Pa s"))
    yield holds("10 Pa s: viscosity", "", thick.limits.get("isph_viscosity", 0) > 10 and "advection" not in thick.limits, str(thick.limits))
    slow = Run(slit(8), ["wcsph.sound_speed=0.02 m/s"])
    yield holds("wcsph, sound slower than the flow: shifting, advection or force", "", bool({"advection", "body_force", "shifting", "viscosity_morris"} & set(slow.limits)) or slow.code == 4, str(slow.limits) + slow.message[-100:])
