//! A way to a state, in words.

use pneudrive_protocol::{decode_reply, decode_request};
use stateright::Path;

use crate::intern::Id;
use crate::line::message;
use crate::{Action, Link, State};

impl Link {
    /// What happens on the way to a state, a line an action.
    #[must_use]
    pub fn story(&self, path: Path<State, Action>) -> String {
        let steps = path.into_vec();
        let lines = steps.iter().filter_map(|(state, action)| Some(self.line(state, action.as_ref()?)));
        lines.collect::<Vec<_>>().join("\n")
    }

    fn line(&self, state: &State, action: &Action) -> String {
        let frame = match *action {
            Action::Asked(host)
            | Action::AskedAndCut(host, _)
            | Action::LosesRequest(host)
            | Action::CopiesRequest(host) => {
                state.to_rig[host].queue.first().map(|frame| self.request(frame.id()))
            }
            Action::AskedLate(host, nth) => Some(self.request(state.to_rig[host].late[nth].id())),
            Action::Answered(host) | Action::LosesReply(host) | Action::CopiesReply(host) => {
                state.to_host[host].queue.first().map(|frame| self.reply(frame.id()))
            }
            Action::AnsweredLate(host, nth) => Some(self.reply(state.to_host[host].late[nth].id())),
            _ => None,
        };
        format!("{action:?} {}", frame.unwrap_or_default())
    }

    fn request(&self, id: Id) -> String {
        let message = message(&self.frames.value(id));
        decode_request(&message).map_or_else(|error| format!("{error:?}"), |request| format!("{request:?}"))
    }

    fn reply(&self, id: Id) -> String {
        let message = message(&self.frames.value(id));
        decode_reply(&message).map_or_else(|error| format!("{error:?}"), |reply| format!("{reply:?}"))
    }
}
