//! The loop on a specimen: identify, compare, diagnose, add, discover.

mod answer;
mod averaged;
mod columns;
mod compare;
mod condense;
mod correction;
mod cost;
mod data;
mod design;
mod doctor;
mod held_out;
mod identify;
mod journal;
mod ladder;
mod law_names;
mod needs;
mod parsimony;
mod priors;
mod probable;
mod problem;
mod roles;
mod simulate;
mod start;
mod strip;
mod told;
mod torn_start;
mod weigh;

pub use answer::{DiscoverAnswer, LadderRow, ScreenRow, diagnose, discover};
pub use averaged::{Averaged, AveragedValue};
pub use columns::{Base, Screened, scales};
pub use compare::{
    AlongTear, DependsOn, Residuals, Where, along_the_tear, depends_on, located, place_in_words, places,
};
pub use condense::condensed;
pub use correction::Correction;
pub use cost::{Meter, Metered, Phase, PhaseCost, Watch, Within};
pub use data::{DataBlock, Measured, RecordError};
pub use design::{
    Asked, Confirmed, DesignAnswer, DesignRequest, Expected, Foresight, Known, RatedProtocol, Variant,
    design, first_look,
};
pub use doctor::{Advice, Doctor, RecordFindings, doctor};
pub use held_out::HeldOut;
pub use identify::{
    AnalysisError, Control, HistoryEntry, Identified, Progress, Stage, free_parameters, identify, run_options,
};
pub use journal::{Journal, NoJournal};
pub use ladder::laws::keeps_meaning;
pub use ladder::{Adds, FeLadder, Fitted, LadderSettings, LeftOut, NextTest, SearchOutcome, Tried, Weighed};
pub use law_names::LawNames;
pub use needs::{Need, needs};
pub use parsimony::{OneStrength, one_strength};
pub use probable::{Brief, LIKELY, Left, PosteriorAnswer, Probable};
pub use problem::{Cancelled, FeProblem};
pub use simulate::{SimulateControl, Simulated, SimulatedTest, replay, simulate};
pub use start::{start_at, stay_at};
pub use told::percent;
