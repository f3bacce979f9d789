//! The forbidden contents of an image of the controller, and the symbols that reveal them.

use std::fmt;

/// A kind of forbidden content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A path that panics, or the text formatting that only a panic needs.
    Panic,
    /// A float computed by a library routine.
    SoftFloat,
    /// A float computed by the processor.
    FloatInstruction,
    /// A division by a library routine, which calls a handler when the divisor is 0.
    Division,
}

impl Kind {
    /// All of them, in the order in which they are reported.
    pub const ALL: [Kind; 4] = [Kind::Panic, Kind::SoftFloat, Kind::FloatInstruction, Kind::Division];

    /// The symbols or instructions that are searched for.
    #[must_use]
    pub fn sought(self) -> &'static str {
        match self {
            Kind::Panic => "symbols with panic, unwind or core::fmt in their names",
            Kind::SoftFloat => "float routines (__aeabi_d*, __aeabi_f*, __aeabi_*2d, __adddf3, ...)",
            Kind::FloatInstruction => "instructions of coprocessors 10 and 11",
            Kind::Division => "division routines (__aeabi_uldivmod, __aeabi_idiv0, __udivdi3, ...)",
        }
    }

    /// The kind of thing that a symbol of this name gives away.
    #[must_use]
    pub fn of_symbol(name: &str) -> Option<Kind> {
        if ["panic", "unwind", "core::fmt", "4core3fmt"].iter().any(|part| name.contains(part)) {
            return Some(Kind::Panic);
        }
        let routine = name.strip_prefix("__")?;
        if is_division(routine) {
            Some(Kind::Division)
        } else if is_soft_float(routine) {
            Some(Kind::SoftFloat)
        } else {
            None
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Kind::Panic => "panic",
            Kind::SoftFloat => "soft float",
            Kind::FloatInstruction => "float instruction",
            Kind::Division => "division routine",
        })
    }
}

/// `__aeabi_idiv`, `__aeabi_uldivmod`, `__aeabi_ldiv0` and the like; `__udivsi3`, `__moddi3`, `__udivmoddi4`.
fn is_division(routine: &str) -> bool {
    if let Some(operation) = routine.strip_prefix("aeabi_") {
        return operation.trim_start_matches(['u', 'i', 'l']).starts_with("div");
    }
    let operation = routine.trim_start_matches('u');
    let types = operation.trim_start_matches("div").trim_start_matches("mod");
    types.len() < operation.len() && starts_with_any(types, &["si", "di", "ti"])
}

/// The names of the run-time ABI (`__aeabi_dadd`, `__aeabi_ui2f`), and of libgcc (`__adddf3`, `__fixsfsi`).
fn is_soft_float(routine: &str) -> bool {
    if let Some(operation) = routine.strip_prefix("aeabi_") {
        return starts_with_any(operation, &["d", "f", "cd", "cf", "h2"])
            || ["2d", "2f"].iter().any(|to| operation.ends_with(to));
    }
    let arithmetic =
        ["add", "sub", "mul", "div", "neg", "pow", "cmp", "eq", "ne", "lt", "le", "gt", "ge", "unord"];
    let conversion = ["float", "fix", "extend", "trunc"];
    starts_with_any(routine, &[&arithmetic[..], &conversion[..]].concat())
        && ["hf", "sf", "df", "tf"].iter().any(|float| routine.contains(float))
}

fn starts_with_any(name: &str, starts: &[&str]) -> bool {
    starts.iter().any(|start| name.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_are(names: &[&str], kind: Option<Kind>) {
        for name in names {
            assert_eq!(Kind::of_symbol(name), kind, "{name}");
        }
    }

    #[test]
    fn panics_are_known_by_either_mangling() {
        all_are(
            &[
                "_ZN4core9panicking18panic_bounds_check17h0123456789abcdefE",
                "_RNvNtCs1234_4core9panicking9panic_fmt",
                "rust_begin_unwind",
                "_ZN4core3fmt9Formatter9write_str17h0123456789abcdefE",
                "_RNvMsa_NtCs1234_4core3fmtNtB5_9Formatter9write_str",
            ],
            Some(Kind::Panic),
        );
    }

    #[test]
    fn float_routines_are_known_by_both_families_of_names() {
        all_are(
            &[
                "__aeabi_dadd",
                "__aeabi_ddiv",
                "__aeabi_fmul",
                "__aeabi_fcmplt",
                "__aeabi_cdcmple",
                "__aeabi_i2d",
                "__aeabi_ui2f",
                "__aeabi_ul2d",
                "__aeabi_l2f",
                "__aeabi_d2iz",
                "__aeabi_h2f",
                "__adddf3",
                "__divsf3",
                "__gtdf2",
                "__unordsf2",
                "__floatunsidf",
                "__fixdfdi",
                "__extendsfdf2",
                "__truncdfsf2",
                "__powidf2",
            ],
            Some(Kind::SoftFloat),
        );
    }

    #[test]
    fn division_routines_are_known_by_both_families_of_names() {
        all_are(
            &[
                "__aeabi_idiv",
                "__aeabi_uidivmod",
                "__aeabi_idiv0",
                "__aeabi_ldiv0",
                "__aeabi_ldivmod",
                "__aeabi_uldivmod",
                "__divsi3",
                "__udivdi3",
                "__umoddi3",
                "__udivmoddi4",
                "__divti3",
            ],
            Some(Kind::Division),
        );
    }

    #[test]
    fn what_moves_memory_or_multiplies_integers_is_allowed() {
        all_are(
            &[
                "memcpy",
                "__aeabi_memcpy4",
                "__aeabi_memclr8",
                "__aeabi_lmul",
                "__aeabi_llsl",
                "__aeabi_ulcmp",
                "__muldi3",
                "probe_sample",
                "_ZN20pneudrive_controller10parameters5TABLE17h0123456789abcdefE",
            ],
            None,
        );
    }
}
