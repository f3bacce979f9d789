"""A drive by its data sheets, simulated by part I of docs/explanation/equations.md and nothing else: no line of pneudrive is in it.

    pneudrive rig show own.toml --json > own.json
    python3 own_drive.py own.json [COUNTS]      # "time_s position_m pressure_1_pa pressure_2_pa" at every sample

COUNTS is a file with what the encoder reads at each sample, a line each; without it that follows from the position. A position that
comes nearer to the edge of a count than two programs are exact may be read differently by them, and goes another way from there on.
"""
import json
import math
import sys

rig = json.load(open(sys.argv[1]))
rig = {key: entry["value"] for key, entry in rig.get("result", {"keys": rig})["keys"].items()}
assert rig["valve.model"] == "iso-6358" and rig["valve.characteristic"] == "linear" and rig["tubing.model"] == "none"
assert rig["controller.loop"] == "closed" and rig["controller.law"] == "gain-profile" and rig["operator.dither_mm"] == 0
READ = [int(line) for line in open(sys.argv[2])] if len(sys.argv) > 2 else None
TOLERANCE = 1e-11

# The gas, supply and surroundings, cylinder and load
n, R = rig["gas.heat_capacity_ratio"], rig["gas.gas_constant_j_per_kg_k"]
P_s, T_s = rig["supply.pressure_pa"], rig["supply.temperature_k"]
P_e, T_e = rig["exhaust.pressure_pa"], rig["exhaust.temperature_k"]
L, bore, rod = rig["actuator.stroke_m"], rig["actuator.bore_m"], rig.get("actuator.rod_diameter_m", 0.0)
A_2 = math.pi / 4 * (bore**2 - rod**2)
A_1 = A_2 if rig["actuator.model"] == "symmetric" else math.pi / 4 * bore**2
V_R1, V_R2 = rig["actuator.residual_volume_1_m3"], rig["actuator.residual_volume_2_m3"]
M, K_C, k_spring = rig["load.mass_kg"], rig["load.viscous_n_s_per_m"], rig["load.spring_n_per_m"]
F_0 = rig["load.constant_force_n"] - M * 9.80665 * math.sin(math.radians(rig["load.incline_deg"]))
STATIC = {1: rig["load.static_extend_n"], -1: rig["load.static_retract_n"]}
SLIDING = {1: rig["load.coulomb_extend_n"], 0: 0.0, -1: -rig["load.coulomb_retract_n"]}
K_e, d = rig["load.stop_stiffness_n_per_m"], rig["load.stop_region_m"]
c_e = 2 * rig["load.stop_damping_ratio"] * math.sqrt(K_e * M)

# The valve and its spool
rho_0, T_0 = 1.185, 293.15
SUPPLY = rig["valve.sonic_conductance_m3_per_s_pa"], rig["valve.critical_ratio"]
EXHAUST = (
    rig.get("valve.exhaust_sonic_conductance_m3_per_s_pa", SUPPLY[0]),
    rig.get("valve.exhaust_critical_ratio", SUPPLY[1]),
)
index, leak = rig["valve.subsonic_index"], rig["valve.leakage_percent"] / 100
X, lap, x_0 = (rig[f"valve.{key}_mm"] / 1e3 for key in ("spool_travel", "underlap", "null_offset"))
K_S, K_D = rig["operator.stiffness_per_mass_per_s2"], rig["operator.damping_per_s"]
limit, gain, w = rig["operator.saturation_mm"] / 1e3, rig["operator.amplifier_gain"], rig["operator.hysteresis_percent"] / 100 * X


# What counts as large: y, v, m_1, P_1, m_2, P_2, x_s, x_s'
SCALES = (L, 1.0, 1e-3, P_s, 1e-3, P_s, X, X * math.sqrt(K_S))


def opening(z):
    return leak + (1 - leak) * z / (X - lap) if z > 0 else leak


def flow(path, a, P_u, T_u, P_d, T_d):
    """kg/s from u to d, negative the other way."""
    if P_d > P_u:
        return -flow(path, a, P_d, T_d, P_u, T_u)
    C, b = path
    r = P_d / P_u
    share = 1.0 if r <= b else (1 - ((r - b) / (1 - b)) ** 2) ** index
    return a * C * rho_0 * P_u * math.sqrt(T_0 / T_u) * share


def net(a_s, a_e, P, T):
    """Flow into a chamber, and the temperature that it carries."""
    s, e = flow(SUPPLY, a_s, P_s, T_s, P, T), flow(EXHAUST, a_e, P_e, T_e, P, T)
    into_s, into_e = max(s, 0.0), max(e, 0.0)
    return s + e, (into_s * T_s + into_e * T_e) / (into_s + into_e) if s + e > 0 else T


def play(u, s):
    return min(max(s, u - w), u + w)


def forces(y, v, P_1, P_2):
    """On the load, but for dry friction."""
    p, rate = (-y, -v) if y < 0 else (y - L, v)
    stop = max(0.0, K_e * p + c_e * rate * min(p / d, 1.0)) if p > 0 else 0.0
    return P_1 * A_1 - P_2 * A_2 - P_e * (A_1 - A_2) + F_0 - k_spring * y - K_C * v + (stop if y < 0 else -stop)


def volumes(y):
    return A_1 * y + V_R1, A_2 * (L - y) + V_R2


def valve(x, s):
    """Where it is as its lands have it."""
    return min(max(play(x, s), -X), X) - x_0


def ports(state, s):
    """The net flow into each chamber, with its temperature."""
    y, _, m_1, P_1, m_2, P_2, x, _ = state
    at, (V_1, V_2) = valve(x, s), volumes(y)
    land_1, land_2 = opening(at - lap), opening(-at - lap)
    return net(land_1, land_2, P_1, P_1 * V_1 / (m_1 * R)), net(land_2, land_1, P_2, P_2 * V_2 / (m_2 * R))


def slopes(state, s, slip, command):
    y, v, _, P_1, _, P_2, x, x_v = state
    V_1, V_2 = volumes(y)
    (m_dot_1, T_1), (m_dot_2, T_2) = ports(state, s)
    return (
        v,
        (forces(y, v, P_1, P_2) - SLIDING[slip]) / M if slip else 0.0,
        m_dot_1,
        n / V_1 * (R * T_1 * m_dot_1 - P_1 * A_1 * v),
        m_dot_2,
        n / V_2 * (R * T_2 * m_dot_2 + P_2 * A_2 * v),
        x_v,
        K_S * (command - x) - K_D * x_v,
    )


def step(state, s, slip, command, h):
    """The classical method of Runge and Kutta."""
    def after(slope, h):
        return tuple(a + h * b for a, b in zip(state, slope))
    one = slopes(state, s, slip, command)
    two = slopes(after(one, h / 2), s, slip, command)
    three = slopes(after(two, h / 2), s, slip, command)
    four = slopes(after(three, h), s, slip, command)
    return tuple(x + h / 6 * (a + 2 * b + 2 * c + e) for x, a, b, c, e in zip(state, one, two, three, four))


def twice(state, s, slip, command, h):
    """Two steps of half the length, and how far one of the whole length is from them."""
    whole = step(state, s, slip, command, h)
    halves = step(step(state, s, slip, command, h / 2), s, slip, command, h / 2)
    error = max(abs(a - b) / scale for a, b, scale in zip(whole, halves, SCALES))
    return tuple(b + (b - a) / 15 for a, b in zip(whole, halves)), error


def room(state, slip):
    """Not negative as long as the load sticks, or slips the same way."""
    if slip:
        return slip * state[1]
    force = forces(*state[:2], state[3], state[5])
    return min(STATIC[1] - force, force + STATIC[-1])


def at_rest(state):
    force = forces(state[0], 0.0, state[3], state[5])
    return 1 if force > STATIC[1] else -1 if force < -STATIC[-1] else 0


def branch(state, s, slip):
    """What changes only between steps: sticking or slipping, stops, the ways of spool and air, which lands are open."""
    y, _, _, P_1, _, P_2, x, x_v = state
    at, flows = valve(x, s), [flow > 0 for flow, _ in ports(state, s)]
    levels = [P > end for P in (P_1, P_2) for end in (P_s, P_e)]
    depths = [y < -d, y < 0, y > L, y > L + d]
    return room(state, slip) >= 0, x_v > 0, abs(play(x, s)) > X, at > lap, -at > lap, flows, levels, depths


def located(state, s, slip, command, h):
    """How long until the branch changes, which it does within h."""
    before, low = branch(state, s, slip), 0.0
    while h - low > 1e-12:
        middle = (low + h) / 2
        if branch(step(state, s, slip, command, middle), s, slip) == before:
            low = middle
        else:
            h = middle
    return h


def advance(state, s, slip, command, duration):
    """As long steps as the error allows, which end where the branch changes."""
    h = duration
    while duration > 1e-12:
        h = min(h, duration)
        new, error = twice(state, s, slip, command, h)
        if error > TOLERANCE:
            h /= 2
            continue
        taken = h
        if branch(new, s, slip) != branch(state, s, slip):
            taken = located(state, s, slip, command, h)
            new, _ = twice(state, s, slip, command, taken)
        s, duration = play(new[6], s), duration - taken
        if room(new, slip) < 0 and slip:
            new = (new[0], 0.0) + new[2:]
            slip = at_rest(new)
        elif room(new, slip) < 0:
            slip = 1 if forces(*new[:2], new[3], new[5]) > 0 else -1
        state = new
        h *= 2 if error < TOLERANCE / 64 else 1
    return state, s, slip


def main():
    count = rig["encoder.mm_per_count"] / 1e3
    T, delay = rig["controller.period_s"], rig["controller.delay_s"]
    K_v, K_a, scale = (rig[f"controller.{key}"] for key in ("velocity_gain", "acceleration_gain", "scale"))
    W_v, W_a = (rig[f"controller.{key}_window_samples"] for key in ("velocity", "acceleration"))
    K_p, span, band = (rig[f"controller.{key}"] for key in ("gain_profile", "profile_span_counts", "dead_band_counts"))
    most = rig["operator.max_command_counts"]
    y, P_2 = rig["test.position_m"], rig["test.pressure_2_pa"]
    P_1 = rig.get("test.pressure_1_pa", (P_2 * A_2 + P_e * (A_1 - A_2) - F_0 + k_spring * y) / A_1)
    m_1 = P_1 * (A_1 * y + V_R1) / (R * rig["test.temperature_1_k"])
    m_2 = P_2 * (A_2 * (L - y) + V_R2) / (R * rig["test.temperature_2_k"])
    state, s, command, seen = (y, 0.0, m_1, P_1, m_2, P_2, 0.0, 0.0), 0.0, 0.0, []
    slip = at_rest(state)
    for k in range(math.floor(rig["test.duration_s"] / T + 1e-9) + 1):
        print(f"{k * T:.6f} {state[0]!r} {state[3]!r} {state[5]!r}")
        seen.append(READ[k] if READ else math.floor(state[0] / count + 1e-9))
        n_k = lambda back: seen[max(k - back, 0)]
        target = [math.floor(mm / 1e3 / count + 0.5) for t, mm in rig["test.moves_mm"] if t <= k * T + 1e-9][-1]
        n_p, n_v = target - n_k(0), n_k(0) - n_k(W_v)
        total = K_p[min(abs(n_p) // span, len(K_p) - 1)] * n_p - K_v * n_v - K_a * (n_v - n_k(W_a) + n_k(W_a + W_v))
        demand = 0 if abs(n_p) < band else math.trunc(total / scale)
        state, s, slip = advance(state, s, slip, command, delay)
        command = min(max(gain * min(max(demand, -most), most) / 2048 * X, -limit), limit)
        state, s, slip = advance(state, s, slip, command, T - delay)


main()
