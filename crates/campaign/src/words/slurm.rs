//! A job script for Slurm: an array whose members each do a share.

use std::path::Path;

/// What the script asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// Members of the array.
    pub array: usize,
    /// Cores of each.
    pub cores: usize,
    /// Time limit, as Slurm takes it: `04:00:00`.
    pub time: String,
    /// Memory of each, as Slurm takes it: `4G`.
    pub memory: String,
}

/// The script. `study`: what `fct campaign run` is given, absolute; `program`: the command.
pub fn slurm(study: &Path, name: &str, program: &str, job: &Job) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect();
    let Job { array, cores, time, memory } = job;
    let study = report::quoted_path(study);
    let program = report::quoted(program);
    format!(
        "#!/bin/bash\n\
         #SBATCH --job-name=fct-{plain}\n\
         #SBATCH --array=1-{array}\n\
         #SBATCH --cpus-per-task={cores}\n\
         #SBATCH --time={time}\n\
         #SBATCH --mem={memory}\n\
         #SBATCH --signal=TERM@120\n\
         #SBATCH --requeue\n\
         # Members may be lost, requeued or sent twice: what is done is never done again.\n\
         exec {program} campaign run {study} --shard \"${{SLURM_ARRAY_TASK_ID}}/{array}\" --threads {cores} --quiet\n"
    )
}
