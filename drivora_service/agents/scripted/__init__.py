"""An ego that follows the script of its document, regardless of other actors."""
