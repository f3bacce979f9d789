//! The stack that a function of an image uses with everything that it calls.
//!
//! A function's frame is the sum of the stack use of all its instructions, wherever they are. No path through it
//! takes more, as long as none of them is in a loop, and compilers do not put them there. The bound is the deepest
//! path along direct calls. Calls by a register are listed, since their targets are not known. A panic is not
//! followed: it ends the program.

use std::collections::BTreeMap;

use anyhow::{Result, bail, ensure};

use crate::frame::Taken;
use crate::image::Image;

/// Part of the name of the function that every panic goes through.
const PANIC: &str = "panic_fmt";

/// The deepest use of the stack by a function.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stack {
    /// Bytes of its own frame and of the frames below it.
    pub bytes: u32,
    /// The functions on the deepest path, from the function itself on.
    pub path: Vec<String>,
    /// Calls by a register, on any path.
    pub indirect: Vec<String>,
}

impl Stack {
    /// The bound on a function's stack.
    ///
    /// # Errors
    /// When there is no such function, or one that it reaches calls itself or takes stack by a register.
    pub fn of(image: &Image, function: &str) -> Result<Stack> {
        ensure!(image.has_function(function), "there is no function {function}");
        let mut walk = Walk { image, known: BTreeMap::new(), path: Vec::new() };
        let bytes = walk.depth(function)?;
        let indirect = walk.known.values().flat_map(|known| known.indirect.iter().cloned()).collect();
        Ok(Stack { bytes, path: walk.path(function), indirect })
    }
}

/// The known facts of a function.
struct Known {
    bytes: u32,
    deepest: Option<String>,
    indirect: Vec<String>,
}

struct Walk<'a> {
    image: &'a Image,
    known: BTreeMap<String, Known>,
    /// The functions from the first one to the one that is examined.
    path: Vec<String>,
}

impl Walk<'_> {
    fn depth(&mut self, name: &str) -> Result<u32> {
        if let Some(known) = self.known.get(name) {
            return Ok(known.bytes);
        }
        if self.path.iter().any(|above| above == name) {
            bail!("{name} calls itself, so its stack has no bound: {}", self.path.join(" > "));
        }
        self.path.push(name.to_owned());
        let (mut frame, mut below, mut deepest, mut indirect) = (0, 0, None, Vec::new());
        for at in self.image.instructions_of(name) {
            match Taken::by(at) {
                Taken::Bytes(bytes) => frame += bytes,
                Taken::Unknown => {
                    bail!("at {:#x} in {name}: a register says how much stack is taken", at.address)
                }
            }
            if at.is_indirect_call() {
                indirect.push(format!("at {:#x} in {name}", at.address));
            }
            if let Some(callee) = self.image.callee(name, at).filter(|callee| !callee.contains(PANIC)) {
                let bytes = self.depth(&callee)?;
                if bytes > below || deepest.is_none() {
                    (below, deepest) = (bytes, Some(callee));
                }
            }
        }
        self.path.pop();
        self.known.insert(name.to_owned(), Known { bytes: frame + below, deepest, indirect });
        Ok(frame + below)
    }

    fn path(&self, function: &str) -> Vec<String> {
        let next = |name: &String| self.known.get(name).and_then(|known| known.deepest.clone());
        std::iter::successors(Some(function.to_owned()), next).collect()
    }
}
