//! What can go wrong with the virtual board.

/// What went wrong, and what to do.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum VirtualBoardError {
    /// There is no QEMU.
    #[error(
        "qemu-system-arm is missing: `cargo xtask image` fetches it on Debian and Ubuntu; elsewhere install QEMU 5.1 or later"
    )]
    NoQemu,
    /// What `BREAKAWAY_QEMU` names does not start.
    #[error("BREAKAWAY_QEMU names {0}, which does not start: name a qemu-system-arm, or unset it")]
    NotQemu(String),
    /// The image is not where it should be.
    #[error("the firmware image {0} is missing: build it by `cargo xtask image`")]
    NoImage(String),
    /// The image is a file of another kind.
    #[error("{0} is not a firmware image (ELF): leave --image out, or name what `cargo xtask image` built")]
    NotAnImage(String),
    /// QEMU did not come up.
    #[error("QEMU does not start: {0}")]
    NotStarted(String),
    /// QEMU or the firmware has ended.
    #[error("the virtual board has ended: {0}")]
    Lost(String),
    /// A file of its own could not be made.
    #[error("cannot prepare the virtual board: {0}")]
    Io(
        #[from]
        #[serde(skip)]
        std::io::Error,
    ),
    /// A flash is to be corrupted, and there is none.
    #[error("corrupt-flash needs a flash that is kept: give its file, --flash FILE")]
    NoFlash,
    /// The cable is to be cut or disturbed, and there is none.
    #[error("this virtual board was started without a cable that can be cut: ask for that when it is started")]
    NoCable,
    /// An option is out of range.
    #[error("{field} = {value} is out of range: it must be {need}")]
    Range {
        /// Option.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        need: &'static str,
    },
}
