//! Errors in words: one line per variant, for messages to people.

/// Implements `Display` and `core::error::Error` for an error type, one format string per variant.
macro_rules! says {
    ($error:ty: $($variant:pat => $text:literal $(($($argument:expr),+))?,)+) => {
        impl core::fmt::Display for $error {
            fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match self {
                    $($variant => write!(out, $text $($(, $argument)+)?),)+
                }
            }
        }

        impl core::error::Error for $error {}
    };
}

pub(crate) use says;
