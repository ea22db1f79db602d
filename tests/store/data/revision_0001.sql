BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0001');
CREATE TABLE attempts (
	run_seq INTEGER NOT NULL, 
	number INTEGER NOT NULL, 
	owner_id VARCHAR(40) NOT NULL, 
	worker VARCHAR(100) NOT NULL, 
	claimed_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, 
	outcome VARCHAR(24) NOT NULL, 
	cause VARCHAR(40) NOT NULL, 
	signal VARCHAR(16) NOT NULL, 
	log TEXT NOT NULL, 
	CONSTRAINT pk_attempts PRIMARY KEY (run_seq, number), 
	CONSTRAINT fk_attempts_owner_id_owners FOREIGN KEY(owner_id) REFERENCES owners (id), 
	CONSTRAINT fk_attempts_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE
);
INSERT INTO "attempts" VALUES(1,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.244397','2026-11-22 23:25:25.368199','2026-11-22 23:25:25.368199','finished','','','');
INSERT INTO "attempts" VALUES(2,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.244397','2026-11-22 23:25:25.368232','2026-11-22 23:25:25.368232','finished','','','');
INSERT INTO "attempts" VALUES(3,1,'01a20594233df8a96cfb4bf4','','2026-11-22 23:25:25.244397',NULL,NULL,'','','','');
INSERT INTO "attempts" VALUES(4,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.491869','2026-11-22 23:25:25.491869','simulator_crashed','signal','SIGSEGV','last line');
INSERT INTO "attempts" VALUES(5,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.668230','2026-11-22 23:25:25.668230','finished','','','');
INSERT INTO "attempts" VALUES(6,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.668253','2026-11-22 23:25:25.668253','infrastructure_failed','worker_lost','','');
INSERT INTO "attempts" VALUES(7,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748269','2026-11-22 23:25:25.748269','finished','','','');
INSERT INTO "attempts" VALUES(8,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748296','2026-11-22 23:25:25.748296','finished','','','');
INSERT INTO "attempts" VALUES(9,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748311','2026-11-22 23:25:25.748311','finished','','','');
INSERT INTO "attempts" VALUES(10,1,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748324','2026-11-22 23:25:25.748324','finished','','','');
INSERT INTO "attempts" VALUES(11,1,'01a20594233df8a96cfb4bf4','','2026-11-22 23:25:25.441655',NULL,NULL,'','','','');
INSERT INTO "attempts" VALUES(12,1,'01a20594233df8a96cfb4bf4','','2026-11-22 23:25:25.441655',NULL,NULL,'','','','');
INSERT INTO "attempts" VALUES(4,2,'01a20594233df8a96cfb4bf4','slot-0','2026-11-22 23:25:25.567912','2026-11-22 23:25:25.617470','2026-11-22 23:25:25.617470','simulator_crashed','signal','SIGSEGV','last line');
INSERT INTO "attempts" VALUES(6,2,'01a20594233df8a96cfb4bf4','','2026-11-22 23:25:26.011960',NULL,NULL,'','','','');
CREATE TABLE batches (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	priority INTEGER NOT NULL, 
	state VARCHAR(16) NOT NULL, 
	created_at DATETIME NOT NULL, 
	size INTEGER NOT NULL, 
	queued INTEGER NOT NULL, 
	served INTEGER NOT NULL, 
	CONSTRAINT pk_batches PRIMARY KEY (seq), 
	CONSTRAINT uq_batches_id UNIQUE (id)
);
INSERT INTO "batches" VALUES(1,'jobs','jobs posted alone',0,'open','2026-11-22 23:25:24.357921',4,0,3);
INSERT INTO "batches" VALUES(2,'01a205942473fcecfc197b10','batch',1,'open','2026-11-22 23:25:24.467928',9,0,11);
INSERT INTO "batches" VALUES(3,'01a2059424bcd0039fa7c0d3','paused',2,'paused','2026-11-22 23:25:24.540259',2,2,0);
INSERT INTO "batches" VALUES(4,'01a2059424da67eeb8254bd4','cancelled',2,'cancelled','2026-11-22 23:25:24.570789',2,0,0);
CREATE TABLE documents (
	sha256 VARCHAR(64) NOT NULL, 
	body TEXT NOT NULL, 
	CONSTRAINT pk_documents PRIMARY KEY (sha256)
);
INSERT INTO "documents" VALUES('a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','{0}');
INSERT INTO "documents" VALUES('cd80994abb0d1e0465acdc560717676578c1774f461babbe67b4b131497a6305','{1}');
INSERT INTO "documents" VALUES('f5e1420e13fd6cca6b2b875d53d06576439e4afec75fcc4a98d7b3b69b10b17e','{2}');
INSERT INTO "documents" VALUES('c7401b91208af75ed9bdf943e87800172f9871b7662e0d30952e12ce41432b42','{3}');
INSERT INTO "documents" VALUES('79bc9b3597a171a403b40fdc3ce66d411aa88ffdf527e2766465408430cfda51','{4}');
INSERT INTO "documents" VALUES('caf8b22a0011849577800b93050eeca10cca7b856c90bcc5b2200ce21ed1ec22','{5}');
INSERT INTO "documents" VALUES('bcd69d66128edb57808dbd5522ef9f1a82acc53a5211bf8936ab7e90e501afb4','{6}');
INSERT INTO "documents" VALUES('d56a5b5f9f0826672864fbd0f06a3c4b221a1be6350097ba49eb555128767fda','{7}');
INSERT INTO "documents" VALUES('8ffab84f301293229d1be75efb0dca213eb538579de22b842b941f7363090616','{8}');
INSERT INTO "documents" VALUES('0f2a693e93e2ed7008feb5b7714bbab236e3907e64188199e3be1ae367f49c40','grid');
CREATE TABLE idempotency_keys (
	"key" VARCHAR(255) NOT NULL, 
	fingerprint VARCHAR(64) NOT NULL, 
	reference TEXT, 
	created_at DATETIME NOT NULL, 
	CONSTRAINT pk_idempotency_keys PRIMARY KEY ("key")
);
INSERT INTO "idempotency_keys" VALUES('key','ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff','01a2059424140d0dbd918c09','2026-11-22 23:25:25.967458');
CREATE TABLE owners (
	id VARCHAR(40) NOT NULL, 
	host VARCHAR(200) NOT NULL, 
	pid INTEGER NOT NULL, 
	started_at DATETIME NOT NULL, 
	heartbeat_at DATETIME NOT NULL, 
	ended_at DATETIME, 
	CONSTRAINT pk_owners PRIMARY KEY (id)
);
INSERT INTO "owners" VALUES('01a20594233df8a96cfb4bf4','vm',29175,'2026-11-22 23:25:24.157811','2026-11-22 23:25:24.157811',NULL);
INSERT INTO "owners" VALUES('01a2059423df3779ee2c2878','vm',29175,'2026-11-22 23:25:24.319987','2026-11-22 23:25:24.319987','2026-11-22 23:25:25.914279');
CREATE TABLE quarantine (
	"key" VARCHAR(64) NOT NULL, 
	document_sha256 VARCHAR(64) NOT NULL, 
	run_id VARCHAR(40) NOT NULL, 
	cause VARCHAR(40) NOT NULL, 
	signal VARCHAR(16) NOT NULL, 
	message TEXT NOT NULL, 
	log TEXT NOT NULL, 
	created_at DATETIME NOT NULL, 
	CONSTRAINT pk_quarantine PRIMARY KEY ("key")
);
INSERT INTO "quarantine" VALUES('a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','01a20594248fae689b3c5a15','signal','SIGSEGV','died of SIGSEGV','last line','2026-11-22 23:25:25.650713');
CREATE TABLE reports (
	run_seq INTEGER NOT NULL, 
	body TEXT NOT NULL, 
	CONSTRAINT pk_reports PRIMARY KEY (run_seq), 
	CONSTRAINT fk_reports_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE
);
INSERT INTO "reports" VALUES(1,'{"run_id":"01a2059424140d0dbd918c09","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"1111111111111111111111111111111111111111111111111111111111111111","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(2,'{"run_id":"01a2059424149481f7c231a6","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}},{"oracle":"collision","ego":"ego","outcome":"violated","message":"collision","at_fault":true,"time":1.0,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(4,'{"run_id":"01a20594248fae689b3c5a15","status":"simulator_crashed","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":{"cause":"signal","message":"died of SIGSEGV","log":"last line"},"versions":{}}');
INSERT INTO "reports" VALUES(5,'{"run_id":"01a20594248f4bf74a067693","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}},{"oracle":"collision","ego":"ego","outcome":"violated","message":"collision","at_fault":true,"time":1.0,"step":null,"location":null,"counterpart":"","evidence":{}},{"oracle":"red_light","ego":"ego","outcome":"violated","message":"red_light","at_fault":true,"time":1.0,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(7,'{"run_id":"01a20594248f7d4d49e23fca","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(8,'{"run_id":"01a20594248fda8a30a7834f","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(9,'{"run_id":"01a20594248f56552a092836","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(10,'{"run_id":"01a20594248fdc7c894e2c2d","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","at_fault":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{}}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":null,"versions":{}}');
INSERT INTO "reports" VALUES(15,'{"run_id":"01a2059425167e0cf8594f09","status":"cancelled","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":{"cause":"cancelled","message":"the run was cancelled","log":""},"versions":{}}');
INSERT INTO "reports" VALUES(16,'{"run_id":"01a2059425164046364bfebc","status":"cancelled","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":{"cause":"cancelled","message":"the run was cancelled","log":""},"versions":{}}');
INSERT INTO "reports" VALUES(17,'{"run_id":"01a2059429a58141777ed87a","status":"simulator_crashed","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"failure":{"cause":"quarantined","message":"not run again: it crashed the simulator in run 01a20594248fae689b3c5a15 (died of SIGSEGV)","log":"last line"},"versions":{}}');
CREATE TABLE runs (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	revision INTEGER NOT NULL, 
	batch_seq INTEGER NOT NULL, 
	item INTEGER NOT NULL, 
	label VARCHAR(200) NOT NULL, 
	document_sha256 VARCHAR(64) NOT NULL, 
	town VARCHAR(100) NOT NULL, 
	agent VARCHAR(200) NOT NULL, 
	agent_override VARCHAR(200) NOT NULL, 
	seed_override INTEGER, 
	status VARCHAR(24) NOT NULL, 
	cause VARCHAR(40) NOT NULL, 
	created_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, 
	cancel_requested BOOLEAN NOT NULL, 
	attempts INTEGER NOT NULL, 
	infrastructure_failures INTEGER NOT NULL, 
	crashes INTEGER NOT NULL, 
	interruptions INTEGER NOT NULL, 
	violations INTEGER, 
	at_fault_violations INTEGER, 
	steps INTEGER, 
	sim_time_s DOUBLE, 
	wall_time_s DOUBLE, 
	trace_sha256 VARCHAR(64) NOT NULL, 
	CONSTRAINT pk_runs PRIMARY KEY (seq), 
	CONSTRAINT fk_runs_batch_seq_batches FOREIGN KEY(batch_seq) REFERENCES batches (seq), 
	CONSTRAINT fk_runs_document_sha256_documents FOREIGN KEY(document_sha256) REFERENCES documents (sha256), 
	CONSTRAINT uq_runs_id UNIQUE (id)
);
INSERT INTO "runs" VALUES(1,'01a2059424140d0dbd918c09',22,1,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.404383','2026-11-22 23:25:25.244397','2026-11-22 23:25:25.368199',0,1,0,0,0,0,0,10,0.0,0.0,'1111111111111111111111111111111111111111111111111111111111111111');
INSERT INTO "runs" VALUES(2,'01a2059424149481f7c231a6',23,1,1,'','cd80994abb0d1e0465acdc560717676578c1774f461babbe67b4b131497a6305','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.404383','2026-11-22 23:25:25.244397','2026-11-22 23:25:25.368232',0,1,0,0,0,1,1,10,0.0,0.0,'');
INSERT INTO "runs" VALUES(3,'01a205942414e9df74c433b1',21,1,2,'','f5e1420e13fd6cca6b2b875d53d06576439e4afec75fcc4a98d7b3b69b10b17e','tee-town','idm','',NULL,'running','','2026-11-22 23:25:24.404383','2026-11-22 23:25:25.244397',NULL,0,1,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(4,'01a20594248fae689b3c5a15',35,2,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','',NULL,'simulator_crashed','signal','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.617470',0,2,0,2,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(5,'01a20594248f4bf74a067693',36,2,1,'','cd80994abb0d1e0465acdc560717676578c1774f461babbe67b4b131497a6305','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.668230',0,1,0,0,0,2,2,10,0.0,0.0,'');
INSERT INTO "runs" VALUES(6,'01a20594248fc77c2aa00b4e',44,2,2,'','f5e1420e13fd6cca6b2b875d53d06576439e4afec75fcc4a98d7b3b69b10b17e','tee-town','idm','',NULL,'running','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655',NULL,0,2,1,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(7,'01a20594248f7d4d49e23fca',38,2,3,'','c7401b91208af75ed9bdf943e87800172f9871b7662e0d30952e12ce41432b42','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748269',0,1,0,0,0,0,0,10,0.0,0.0,'');
INSERT INTO "runs" VALUES(8,'01a20594248fda8a30a7834f',39,2,4,'','79bc9b3597a171a403b40fdc3ce66d411aa88ffdf527e2766465408430cfda51','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748296',0,1,0,0,0,0,0,10,0.0,0.0,'');
INSERT INTO "runs" VALUES(9,'01a20594248f56552a092836',40,2,5,'','caf8b22a0011849577800b93050eeca10cca7b856c90bcc5b2200ce21ed1ec22','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748311',0,1,0,0,0,0,0,10,0.0,0.0,'');
INSERT INTO "runs" VALUES(10,'01a20594248fdc7c894e2c2d',41,2,6,'','bcd69d66128edb57808dbd5522ef9f1a82acc53a5211bf8936ab7e90e501afb4','tee-town','idm','',NULL,'finished','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655','2026-11-22 23:25:25.748324',0,1,0,0,0,0,0,10,0.0,0.0,'');
INSERT INTO "runs" VALUES(11,'01a20594248fe766e70f489c',43,2,7,'','d56a5b5f9f0826672864fbd0f06a3c4b221a1be6350097ba49eb555128767fda','tee-town','idm','',NULL,'running','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655',NULL,1,1,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(12,'01a20594248f2f7a36dd08a5',32,2,8,'','8ffab84f301293229d1be75efb0dca213eb538579de22b842b941f7363090616','tee-town','idm','',NULL,'running','','2026-11-22 23:25:24.513170','2026-11-22 23:25:25.441655',NULL,0,1,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(13,'01a2059424fa177452b7e396',13,3,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','',NULL,'queued','','2026-11-22 23:25:24.628561',NULL,NULL,0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(14,'01a2059424fa5a0e489c2a4a',14,3,1,'','0f2a693e93e2ed7008feb5b7714bbab236e3907e64188199e3be1ae367f49c40','grid','krauss','',NULL,'queued','','2026-11-22 23:25:24.628561',NULL,NULL,0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(15,'01a2059425167e0cf8594f09',17,4,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','',NULL,'cancelled','cancelled','2026-11-22 23:25:24.656095',NULL,'2026-11-22 23:25:24.742112',0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(16,'01a2059425164046364bfebc',18,4,1,'','0f2a693e93e2ed7008feb5b7714bbab236e3907e64188199e3be1ae367f49c40','grid','krauss','',NULL,'cancelled','cancelled','2026-11-22 23:25:24.656095',NULL,'2026-11-22 23:25:24.742112',0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "runs" VALUES(17,'01a2059429a58141777ed87a',42,1,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','',NULL,'simulator_crashed','quarantined','2026-11-22 23:25:25.818175',NULL,'2026-11-22 23:25:25.818175',0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,'');
CREATE TABLE slots (
	owner_id VARCHAR(40) NOT NULL, 
	name VARCHAR(100) NOT NULL, 
	pid INTEGER, 
	run_id VARCHAR(40) NOT NULL, 
	phase VARCHAR(16) NOT NULL, 
	step INTEGER NOT NULL, 
	memory_bytes INTEGER NOT NULL, 
	runs INTEGER NOT NULL, 
	restarts INTEGER NOT NULL, 
	last_crash TEXT NOT NULL, 
	updated_at DATETIME NOT NULL, 
	CONSTRAINT pk_slots PRIMARY KEY (owner_id, name), 
	CONSTRAINT fk_slots_owner_id_owners FOREIGN KEY(owner_id) REFERENCES owners (id) ON DELETE CASCADE
);
CREATE TABLE verdicts (
	seq INTEGER NOT NULL, 
	run_seq INTEGER NOT NULL, 
	oracle VARCHAR(60) NOT NULL, 
	ego VARCHAR(200) NOT NULL, 
	outcome VARCHAR(16) NOT NULL, 
	at_fault BOOLEAN, 
	time DOUBLE, 
	counterpart VARCHAR(200) NOT NULL, 
	CONSTRAINT pk_verdicts PRIMARY KEY (seq), 
	CONSTRAINT fk_verdicts_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE
);
INSERT INTO "verdicts" VALUES(1,2,'collision','ego','violated',1,1.0,'');
INSERT INTO "verdicts" VALUES(2,5,'collision','ego','violated',1,1.0,'');
INSERT INTO "verdicts" VALUES(3,5,'red_light','ego','violated',1,1.0,'');
CREATE INDEX ix_batches_claimable ON batches (priority, served, seq) WHERE queued > 0 AND state = 'open';
CREATE INDEX ix_idempotency_keys_created_at ON idempotency_keys (created_at);
CREATE INDEX ix_quarantine_document_sha256 ON quarantine (document_sha256);
CREATE INDEX ix_runs_agent ON runs (agent, seq);
CREATE INDEX ix_runs_batch_seq_status ON runs (batch_seq, status);
CREATE INDEX ix_runs_document_sha256 ON runs (document_sha256);
CREATE INDEX ix_runs_queued ON runs (batch_seq, seq) WHERE status = 'queued';
CREATE INDEX ix_runs_revision ON runs (revision);
CREATE INDEX ix_runs_status ON runs (status, seq);
CREATE INDEX ix_runs_to_cancel ON runs (seq) WHERE status = 'running' AND cancel_requested;
CREATE INDEX ix_runs_town ON runs (town, seq);
CREATE INDEX ix_runs_violated ON runs (batch_seq, seq) WHERE violations > 0;
CREATE INDEX ix_attempts_leases ON attempts (owner_id) WHERE ended_at IS NULL;
CREATE INDEX ix_verdicts_oracle ON verdicts (oracle, outcome, run_seq);
CREATE INDEX ix_verdicts_run_seq ON verdicts (run_seq);
COMMIT;
