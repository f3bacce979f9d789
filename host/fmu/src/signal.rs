//! An input or output of a model: its type, its value.

/// A type of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// fmi3Float64.
    Float64,
    /// fmi3Int32.
    Int32,
    /// fmi3Int64.
    Int64,
    /// fmi3Boolean.
    Boolean,
}

impl Kind {
    /// The name of the type.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Kind::Float64 => "Float64",
            Kind::Int32 => "Int32",
            Kind::Int64 => "Int64",
            Kind::Boolean => "Boolean",
        }
    }
}

/// The value of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Of a Float64.
    Float(f64),
    /// Of an Int32 or Int64.
    Integer(i64),
    /// Of a Boolean.
    Switch(bool),
}

impl Value {
    /// That of a key of a rig file; None of a text or a list.
    #[must_use]
    pub fn of_key(value: &pneudrive_sim::rig::Value) -> Option<Value> {
        use pneudrive_sim::rig::Value as Of;
        match value {
            Of::Number(number) => Some(Value::Float(*number)),
            Of::Integer(number) => Some(Value::Integer(*number)),
            Of::Switch(on) => Some(Value::Switch(*on)),
            _ => None,
        }
    }
}

impl std::fmt::Display for Value {
    /// In TOML and XML: a Float64 with enough digits to distinguish it from all others.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Float(value) => write!(f, "{value:?}"),
            Value::Integer(value) => write!(f, "{value}"),
            Value::Switch(value) => write!(f, "{value}"),
        }
    }
}

/// A signal of a model.
#[derive(Clone, Copy, Debug)]
pub struct Signal {
    /// With its unit at the end.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// Its type.
    pub meaning: &'static str,
    /// The least and the most that an input takes.
    pub range: Option<[i64; 2]>,
}
