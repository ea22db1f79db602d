"""An ego that drives where its document says, whatever happens."""
