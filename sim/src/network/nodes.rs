//! Both nodes at once, and their boundary conditions.

use super::{Node, PortFlow};
use crate::component::air::GasState;
use crate::component::valve::Conductances;
use crate::number::{Number, Pair};

/// The same number for both.
#[inline(always)]
pub(super) fn pair(value: f64) -> Pair {
    Pair::splat(value)
}

/// The boundary conditions of the nodes: gas states and directions of the flows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundaryConditions {
    pub valve: Conductances<Pair>,
    pub chambers: GasState<Pair>,
    /// Whether the port's air flows into the cylinder.
    pub charging: <Pair as Number>::Truth,
    /// Whether a land is shut, without even a clearance.
    pub has_shut_land: bool,
}

/// Both nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nodes {
    /// w_n.
    pub exner: Pair,
    /// T_n, K: of the air that leaves by the lands.
    pub temperature: Pair,
    /// Temperature of the air that goes on into the cylinder, K.
    pub carried: Pair,
    /// s, kg/s, from the supply.
    pub supply: Pair,
    /// e, kg/s, from the exhaust; negative when air leaves.
    pub exhaust: Pair,
}

impl BoundaryConditions {
    #[inline(always)]
    pub fn new(
        valve: Conductances<Pair>,
        chambers: GasState<Pair>,
        ports: &[PortFlow; 2],
    ) -> BoundaryConditions {
        let zero = pair(0.0);
        let open = Pair::all(valve.supply.above(zero) & valve.exhaust.above(zero));
        BoundaryConditions { valve, chambers, charging: PortFlow::charging(ports), has_shut_land: !open }
    }

    /// The direction of the air in port `i`.
    pub fn port(&self, i: usize) -> PortFlow {
        // A mask that is true has all its bits set.
        match self.charging.lane(i).to_bits() {
            0 => PortFlow::Discharging,
            _ => PortFlow::Charging,
        }
    }

    /// Whether these are valid pressures, temperatures and areas.
    #[inline(always)]
    pub fn are_in_order(&self) -> bool {
        let (zero, infinity) = (pair(0.0), pair(f64::INFINITY));
        let usable = |value: Pair| value.above(zero) & infinity.above(value);
        let chambers = usable(self.chambers.exner) & usable(self.chambers.temperature);
        Pair::all(chambers & infinity.above(self.valve.supply.abs()))
    }
}

impl PortFlow {
    /// The ports whose air flows into the cylinder.
    #[inline(always)]
    pub(crate) fn charging(ports: &[PortFlow; 2]) -> <Pair as Number>::Truth {
        Pair::of(|i| f64::from(ports[i] == PortFlow::Charging)).above(pair(0.0))
    }
}

impl Nodes {
    pub const NOT_NUMBERS: Nodes = Nodes::alike(Node::NOT_A_NUMBER);

    pub const fn alike(node: Node) -> Nodes {
        Nodes::of(&[node; 2])
    }

    pub const fn of([one, two]: &[Node; 2]) -> Nodes {
        Nodes {
            exner: Pair::new([one.exner, two.exner]),
            temperature: Pair::new([one.temperature, two.temperature]),
            carried: Pair::new([one.carried, two.carried]),
            supply: Pair::new([one.supply_flow, two.supply_flow]),
            exhaust: Pair::new([one.exhaust_flow, two.exhaust_flow]),
        }
    }

    /// Each of them.
    pub fn each(&self) -> [Node; 2] {
        [0, 1].map(|i| Node {
            exner: self.exner.lane(i),
            temperature: self.temperature.lane(i),
            carried: self.carried.lane(i),
            supply_flow: self.supply.lane(i),
            exhaust_flow: self.exhaust.lane(i),
        })
    }

    /// Where their air is.
    #[inline(always)]
    pub fn stations(&self) -> GasState<Pair> {
        GasState { exner: self.exner, temperature: self.temperature }
    }

    /// m, kg/s, into the cylinder.
    #[inline(always)]
    pub fn port_flow(&self) -> Pair {
        self.supply + self.exhaust
    }

    pub fn are_finite(&self) -> bool {
        self.each().iter().all(Node::is_finite)
    }
}
